// A strand network on the hair of a scene.
#include "app/engine/learned_hair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/engine/scene_changes.h"
#include "app/engine/simulated_frames.h"
#include "base/error.h"
#include "learn/codec/network_module.h"
#include "learn/codec/stencil.h"
#include "solver/chain/scene_checks.h"
#include "solver/scene/rest_state.h"
#include "solver/solids/rest_depths.h"

namespace wetcurl {

void require_solids_for(const ModelCard& card, bool locks, const Scene& scene, const std::string& file) {
    const bool displayed = card.target == "displayed";
    if (!displayed && !locks) return;
    for (const Solid& solid : scene.solids)
        if (!solid.attached || solid.deformation)
            throw Error(file + ": solid '" + solid.name + "' " +
                        (solid.deformation ? "deforms" : "is not attached to the head") + ", allowed for " +
                        (displayed
                             ? "a network of displayed strands is what moves with the head; one trained "
                               "with target = \"strands\" is kept out of every solid"
                             : "locks by a grid is what moves with the head; Eq 10 by neighbours, which "
                               "follows in their place, keeps strands out of every solid"));
}

void require_rigid_scalp(const Scene& scene, const std::string& file) {
    if (scene.riding)
        throw Error(file +
                    ": its hair rides on a solid that deforms, allowed for networks and interpolation "
                    "is hair that moves with a rigid head; `wetcurl simulate` simulates the scene");
}

HairTraits traits_of(const Scene& scene, double low_step) {
    HairTraits t;
    if (const auto& fibre = scene.fibre) {
        t.rigidity = fibre->flexural_rigidity();
        t.wet_rigidity = t.rigidity * fibre->wet_springs().at(1).bend;
    } else if (const auto& bend = scene.term<Bend>()) {
        t.rigidity = t.wet_rigidity = bend->k_b * std::pow(mean_segment(scene.groom), 3);
    }
    t.density = t.wet_density = scene.linear_density;
    if (scene.wetness) t.wet_density = scene.wetness->wet_mass(t.density, 1);
    if (const auto& drag = scene.term<Stiffness>())
        t.drag = drag->c_all + drag->c_dry, t.wet_drag = drag->c_all + drag->c_wet;
    t.reach = scene.cohesion ? scene.cohesion->h_c : 0;
    t.low_step = low_step, t.fps = scene.fps;
    return t;
}

int passes_after_displayed(int passes) { return std::max(1, int(std::lround(passes * 8 / 14.0))); }

LockTerms lock_terms_of(Cohesion term, int passes, double fps) {
    term.passes = passes, term.relaxation = Cohesion::most_relaxation;
    LockTerms terms{float(term.h_c), float(term.coherence), float(term.stretch), {}, averaged_frames(fps)};
    for (int k = 0; k < term.sweeps(); ++k) terms.sweeps.push_back(float(term.of_sweep(k).lambda));
    return terms;
}

static void keep_outside_head(LearnedStrands& learned, const Scene& scene) {
    if (!scene.has_solid_with_roots()) return;
    HeadShapes head;
    for (const Solid& solid : scene.solids) head.shapes.push_back(solid.shape);
    head.depth = rest_depths_of(scene);
    learned.keep_outside(head);
}

void draw_together(LearnedStrands& learned, const Scene& scene, const std::string& scene_file, int passes,
                   double fps) {
    if (!scene.cohesion)
        throw Error(scene_file +
                    ": has no [cohesion], which says how locks are drawn; add it, or leave locks out");
    require_solids_for(learned.card(), true, scene, scene_file);
    keep_outside_head(learned, scene);
    learned.draw_together(lock_terms_of(*scene.cohesion, passes, fps), scene.saturation);
    learned.lead_edges(most_length_rounds);
}

std::vector<uint8_t> wet_strands_of(const Scene& scene) {
    std::vector<uint8_t> wet(size_t(scene.groom.rest.count), 0);
    const size_t particles = size_t(scene.groom.rest.particles);
    for (size_t k = 0; k < scene.saturation.size(); ++k)
        if (scene.saturation[k] > 0) wet[k / particles] = 1;
    return wet;
}

// Offsets from the roots, in the head's frame.
static Strands at_rest(Scene scene, const std::string& device) {
    leave_out_display(scene);
    constexpr double long_enough = 1.5;  // [s]
    scene.integrator.settle = std::max(scene.integrator.settle, long_enough);
    RunFrame frame;
    const auto simulation = make_simulation_on(device, scene, trusted_precision(scene, "float"));
    SimulatedFrames(*simulation, 1).next(frame);
    Strands& p = frame.positions;
    const Quatf to_head = cast<float>(conjugate(frame.head.rotation));
    for (int s = 0; s < p.count; ++s)
        for (int i = p.particles - 1; i >= 0; --i) p.at(s, i) = rotate(to_head, p.at(s, i) - p.at(s, 0));
    return p;
}

Settled settled_of(const Scene& scene, const std::string& scene_file, const Groom& low, int dry_substeps,
                   const std::string& where) {
    // A program built without the solver's CUDA backend may still have a network there.
    const std::string device = names_of_cuda_devices().empty() ? "cpu" : where;
    require_part(scene.groom, low);
    const Scene wet = part_of_scene(scene, twins_of(scene.groom, low));
    if (!acts_wet(wet))
        throw Error(scene_file +
                    ": nothing in it acts on wet hair, needed is [wetness] to know where that rests");
    Scene dry = wet;
    set_substeps(dry, dry_substeps);
    make_dry(dry);
    return settled_between(at_rest(std::move(dry), device), at_rest(wet, device));
}

std::unique_ptr<LearnedStrands> learned_strands_of(const std::string& model, const Scene& scene,
                                                   const std::string& scene_file, const Groom& low,
                                                   double low_step, const std::string& device, int threads,
                                                   const Settled* settled) {
    const ModelCard card = network_module().card(model);
    if (card.codec != "strand")
        throw Error(model + ": found a model of codec " + card.codec + ", allowed is one of codec strand");
    require_rigid_scalp(scene, scene_file);
    require_solids_for(card, false, scene, scene_file);
    const Strands shape = shape_at_rest(scene);
    auto learned =
        network_module().load_strands(model,
                                      StrandCodec(scene.groom, low, scene.saturation, &shape,
                                                  card.low == "wet", traits_of(scene, low_step), settled),
                                      low, device, threads);
    if (card.target == "displayed") keep_outside_head(*learned, scene);
    return learned;
}

LearnedHair::LearnedHair(std::unique_ptr<LearnedStrands> strands, const Scene& scene,
                         const std::string& device, bool clumps)
    : strands_(std::move(strands)) {
    if (!clumps) return;
    display_.emplace(device, scene);
    before_ = scene.groom.rest;
}

void LearnedHair::draw_together(const Scene& scene, const std::string& scene_file, int passes) {
    wetcurl::draw_together(*strands_, scene, scene_file, passes, scene.fps);
    display_.reset();
}

void LearnedHair::bind(const Vec3f* low, Vec3f* displayed, bool on_device) {
    Vec3f* out = displayed;
    if (display_) {
        DeviceDisplay* there = display_->device();
        if (on_device && !there)
            throw Error(
                "cohesion follows this model, which predicts strands before it, and this hair's is computed "
                "on "
                "the host; models of displayed strands run on a device without it");
        out = on_device ? there->strands() : before_.points.data();
    }
    strands_->bind(low, out, on_device);
    displayed_ = displayed, on_device_ = on_device;
}

void LearnedHair::run(const HeadWindow& heads, double time) {
    if (display_ && on_device_) {
        display_->device()->apply(displayed_, heads.now, time, strands_->begin(heads));
        return;
    }
    strands_->run(heads);
    if (!display_) return;
    display_->apply(before_, heads.now, time);
    std::copy(before_.points.begin(), before_.points.end(), displayed_);
}

}  // namespace wetcurl
