// A strand network on the hair of a scene: what `infer`, `bench` and the library for other programs share.
#pragma once

#include <optional>

#include "app/engine/device.h"
#include "learn/codec/learned_strands.h"
#include "solver/scene/scene.h"

namespace wetcurl {

// Throws Error, naming `file`, where no Eq 10 by neighbours follows (the model, its card, predicts displayed
// strands, or `locks` are drawn by a grid) and a solid of the scene is not attached to the head or deforms:
// nothing would keep strands out of it.
void require_solids_for(const ModelCard& card, bool locks, const Scene& scene, const std::string& file);

// Throws Error, naming `file`, where roots of the scene ride on a solid that deforms: networks and
// interpolation place them on a rigid head.
void require_rigid_scalp(const Scene& scene, const std::string& file);

// What a network is told of a scene's hair; `low_step`: of its low-resolution run [s].
HairTraits traits_of(const Scene& scene, double low_step);

// Of a scene's passes of Eq 10 those that displayed strands want yet. They hang together already, only too
// little: 8 in 14 give as many neighbours within 4 mm as the reference has, all of them half as many again on
// the demo.
int passes_after_displayed(int passes);

// So many passes of Eq 10, in over-relaxed sweeps whatever the scene says; fps: frames a second.
LockTerms lock_terms_of(Cohesion term, int passes, double fps);
// Strands of the scene are drawn together by so many passes of Eq 10 on a grid, and kept out of what is
// attached to the head. Throws Error, naming `scene_file`, without [cohesion] and as require_solids_for, and
// as LearnedStrands::draw_together.
void draw_together(LearnedStrands& learned, const Scene& scene, const std::string& scene_file, int passes,
                   double fps);

// Whether there is water on a strand, (strand).
std::vector<uint8_t> wet_strands_of(const Scene& scene);

// Where the low-resolution strands of a scene would be, were they wet. They are simulated wet and dry until
// they come to rest, for as long as the scene settles, but 1.5 s or longer; dry ones in so many substeps a
// frame. Throws Error where nothing in the scene acts on wet hair.
// `low`: which strands these are, of the scene's. Throws Error where one is none of them.
Settled settled_of(const Scene& scene, const std::string& scene_file, const Groom& low, int dry_substeps,
                   const std::string& device);

// The model of that file with the codec of the scene's hair, kept out of what is attached to the head where
// it predicts displayed strands. scene: of `scene_file`, at the resolution to predict, its saturation known;
// low: the groom of the low-resolution run, and its step [s]; settled: as of a StrandCodec, for a dry run
// where the model learned from wet ones. Throws Error where these do not fit, Misuse for a device's name.
std::unique_ptr<LearnedStrands> learned_strands_of(const std::string& model, const Scene& scene,
                                                   const std::string& scene_file, const Groom& low,
                                                   double low_step, const std::string& device, int threads,
                                                   const Settled* settled = nullptr);

// A strand network and, where it follows, Eq 10: from low-resolution strands to displayed ones, all in the
// memory of the host or all in that of a device.
class LearnedHair {
  public:
    // `clumps`: Eq 10 follows. The scene must outlive this.
    LearnedHair(std::unique_ptr<LearnedStrands> strands, const Scene& scene, const std::string& device,
                bool clumps);
    LearnedStrands& strands() { return *strands_; }
    // As wetcurl::draw_together, in the place of Eq 10, at the scene's frame rate; before anything is bound.
    void draw_together(const Scene& scene, const std::string& scene_file, int passes);
    // As LearnedStrands::bind; `displayed` (high strands, particles). Throws Error too where they lie on a
    // device and Eq 10 is computed on the host.
    void bind(const Vec3f* low, Vec3f* displayed, bool on_device);
    bool is_bound() const { return displayed_ != nullptr; }
    // As LearnedStrands::run; `time` [s] of the frame.
    void run(const HeadWindow& heads, double time);

  private:
    std::unique_ptr<LearnedStrands> strands_;
    std::optional<DisplayOn> display_;
    Strands before_;  // Eq 10, on the host
    Vec3f* displayed_ = nullptr;
    bool on_device_ = false;
};

}  // namespace wetcurl
