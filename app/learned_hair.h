// A strand network on the hair of a scene: what `infer`, `bench` and the library for other programs share.
// Ours.
#pragma once

#include "learn/learned_strands.h"
#include "solver/scene.h"

namespace wetcurl {

// Throws Error, naming `file`, where the model (its card) predicts displayed strands, which run without Eq
// 10, and a solid of the scene is not attached to the head or deforms: nothing would keep strands out of it.
void require_solids_for(const ModelCard& card, const Scene& scene, const std::string& file);

// Reach of Eq 10 on what is displayed of the scene [m], 0 without it.
double reach_of(const Scene& scene);

// How far strands come to rest, wet, from where they do dry: (strands, particles), in the head's frame [m].
// Both are simulated for it, for as long as their scenes settle, but 1.5 s or longer. The scenes may differ
// in their substeps; the second is made dry here. Throws Error where nothing in the first acts on wet hair.
Strands settled_of(const Scene& wet, Scene dry, const std::string& device);

// The low-resolution hair of a scene, `substeps` a frame (0: its own).
Scene low_scene_of(const Scene& scene, const std::string& scene_file, int substeps = 0);

// The model of that file with the codec of the scene's hair, kept out of what is attached to the head where
// it predicts displayed strands. scene: of `scene_file`, at the resolution to predict, its saturation known;
// low: the groom of the dry run. Where the model's low-resolution strands have settled, that is simulated
// here. Throws Error where these do not fit, Misuse for a device's name.
std::unique_ptr<LearnedStrands> learned_strands_of(const std::string& model, const Scene& scene,
                                                   const std::string& scene_file, const Groom& low,
                                                   const std::string& device, int threads);

}  // namespace wetcurl
