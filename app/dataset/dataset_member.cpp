// One scene of a data set.
#include "app/dataset/dataset_member.h"

#include <fmt/format.h>

#include <set>

#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "app/engine/run_of_scene.h"
#include "app/engine/scene_changes.h"
#include "app/engine/simulated_frames.h"
#include "learn/codec/encode_runs.h"
#include "solver/chain/scene_checks.h"
#include "solver/scene/findings.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

namespace {

// At full resolution. Throws as load_scene does, the member's name first.
Scene scene_of(const DatasetRecipe& recipe, const DatasetMember& m) {
    Config config = m.scene();
    if (!config.root().has("wetness"))
        throw Misuse(recipe.scene_line + ": " + m.name +
                     " has no [wetness], which is what is to be learned; " +
                     "neither the scene that it starts from nor what was picked and drawn for it names one");
    try {
        Scene scene = parse_scene(config);
        act_on(findings_of(scene), scene, "its scene");
        if (scene.flow) throw Misuse("its water moves ([wetness.flow]), allowed is wetness that stays");
        if (!scene.adhesion_model.empty())
            throw Misuse(
                "it names a network in place of Eq 11 ([adhesion] model), allowed is the physics, which is "
                "what is learned");
        if (scene.riding)
            throw Misuse(
                "its hair rides on a solid that deforms, allowed is hair that moves with a rigid head");
        if (recipe.first >= scene.frames)
            throw Misuse(fmt::format("{}: found {}, allowed 0 to {}, since the scene has {} frames",
                                     recipe.first_line, recipe.first, scene.frames - 1, scene.frames));
        return scene;
    } catch (const Misuse& e) {
        throw Misuse(m.name + ": " + e.what());
    } catch (const Error& e) {
        throw Error(m.name + ": " + e.what());
    }
}

// The scene of its low-resolution run.
Scene low_of(const DatasetRecipe& recipe, const DatasetMember& m, const Scene& high) {
    try {
        Scene low = low_resolution_of(high, m.low);
        if (m.low_substeps) set_substeps(low, m.low_substeps);
        if (!recipe.low_is_wet) make_dry(low);
        // Eq 10 changes only what is displayed, and no network sees that of the low-resolution run.
        leave_out_display(low);
        if (low.groom.rest.count >= high.groom.rest.count)
            throw Misuse(
                fmt::format("found {} low-resolution strands of {}, allowed are fewer (low_strides, "
                            "low_guides)",
                            low.groom.rest.count, high.groom.rest.count));
        return low;
    } catch (const Misuse& e) {
        throw Misuse(m.name + ": " + e.what());
    } catch (const Error& e) {
        throw Error(m.name + ": " + e.what());
    }
}

using Images = std::vector<std::pair<std::vector<float>, std::vector<float>>>;  // (frame): input, target

struct StrandImages {
    std::vector<float> input, target, displayed;  // of one frame
};

class MemberRun {
  public:
    MemberRun(const DatasetRecipe& recipe, const DatasetMember& m, const DatasetFolder& to, Places places,
              const std::string& device)
        : recipe_(recipe),
          member_(m),
          to_(to),
          places_(std::move(places)),
          high_(scene_of(recipe, m)),
          low_(low_of(recipe, m, high_)),
          traits_(traits_of(high_, 1 / (low_.fps * low_.integrator.substeps))) {
        if (!recipe.root && !recipe.displayed && !keeps_runs()) leave_out_display(high_);
        wet_ = make_simulation_on(device, high_, trusted_precision(high_, "float"));
        dry_ = make_simulation_on(device, low_, trusted_precision(low_, "float"));
    }

    bool compute(const InterruptGuard& guard) {
        std::optional<StrandEncoder> strands;
        if (recipe_.strand) {
            const Strands shape = shape_at_rest(high_);
            strands.emplace(high_.groom, low_.groom, high_.saturation, &shape, recipe_.low_is_wet, traits_);
        }
        std::unique_ptr<RunWriter> low_writer, wet_writer;
        if (keeps_runs()) {
            low_writer = writer("low", low_, *dry_);
            wet_writer = writer("wet", high_, *wet_);
        }
        const float radius = high_.cohesion ? float(high_.cohesion->h_c) : 0;
        const RootImage low_image(low_.groom.grid), high_image(high_.groom.grid, 2);
        SimulatedFrames low_frames(*dry_, high_.frames), wet_frames(*wet_, high_.frames);
        FrameDelivery frames({"", high_.frames}, guard);
        RunFrame wet;
        frames.run(low_frames, [&](int f, const RunFrame& low) {
            const bool kept = f >= recipe_.first && (f - recipe_.first) % recipe_.every < recipe_.together,
                       shown = kept || keeps_runs();
            // Eq 10 is left out of frames that nobody sees.
            wet_frames.advance(shown);
            if (strands) strands->take_up(low.positions, heads_at(f));
            if (!shown) return;
            wet_frames.begin(wet), wet_frames.finish(wet);
            if (keeps_runs()) low_writer->append(low), wet_writer->append(wet);
            if (!kept) return;
            frames_.push_back(f);
            if (strands) {
                StrandImages& images = strand_images_.emplace_back();
                images.input = strands->dynamic();
                floor_mm_ += strands->encode(wet.positions, images.target);
                if (displayed()) floor_displayed_mm_ += strands->encode(wet.seen(), images.displayed);
            }
            if (recipe_.root)
                root_images_.emplace_back(
                    root_colours(low_image, low.positions, {}, radius, recipe_.box),
                    root_colours(high_image, wet.seen(), high_.saturation, radius, recipe_.box));
        });
        if (!frames.is_whole()) return false;
        if (strands) write_strands(*strands);
        if (recipe_.root) write_roots(low_image, high_image, radius);
        if (keeps_runs()) low_writer->commit(), wet_writer->commit();
        return true;
    }

  private:
    bool keeps_runs() const { return recipe_.runs == member_.split; }
    HeadWindow heads_at(int f) const {
        const auto at = [&](int frame) { return high_.head_at(frame / high_.fps); };
        HeadWindow heads;
        heads.fps = high_.fps, heads.gravity = high_.integrator.gravity;
        heads.before = at(f - 1), heads.now = at(f);
        heads.after = f + 1 < high_.frames ? at(f + 1) : gone_on(heads.before, heads.now);
        heads.inner = f > 0;
        return heads;
    }
    bool displayed() const { return recipe_.displayed && high_.cohesion; }
    void write_strands(const StrandEncoder& encoder) {
        PairsWriter out = shard(Codec::strand);
        out.low(recipe_.low_is_wet, low_.integrator.substeps);
        StrandPairs run = encoder.begin(int(strand_images_.size()), displayed());
        run.frame = frames_;
        out.begin(run);
        for (const auto& i : strand_images_)
            out.append(i.input.data(), i.target.data(), displayed() ? i.displayed.data() : nullptr);
        out.attribute("floor_mm", floor_mm_ / double(strand_images_.size()));
        if (displayed())
            out.attribute("floor_displayed_mm", floor_displayed_mm_ / double(strand_images_.size()));
        out.commit();
    }
    void write_roots(const RootImage& low, const RootImage& high, float radius) {
        PairsWriter out = shard(Codec::root);
        out.low(recipe_.low_is_wet, low_.integrator.substeps);
        out.box(&recipe_.box.lower.x, &recipe_.box.upper.x);
        out.attribute("support_radius", radius);
        out.begin(RootPairs{int(root_images_.size()), low.height(), low.width(), low.mask(), high.mask()});
        for (const auto& [input, target] : root_images_) out.append(input.data(), target.data());
        out.commit();
    }
    PairsWriter shard(Codec codec) {
        return {std::move(places_.at(to_.shard(member_, codec))), codec, high_.groom.rest.particles};
    }
    std::unique_ptr<RunWriter> writer(const char* which, const Scene& scene, const Simulation& simulation) {
        return std::make_unique<RunWriter>(std::move(places_.at(to_.run(member_, which))),
                                           header_of(scene, simulation, method_of(scene)));
    }

    const DatasetRecipe& recipe_;
    const DatasetMember& member_;
    const DatasetFolder& to_;
    Places places_;
    Scene high_, low_;
    HairTraits traits_;  // of Eq 10 too, which may be left out of them
    std::unique_ptr<Simulation> dry_, wet_;
    std::vector<int> frames_;  // kept
    std::vector<StrandImages> strand_images_;
    Images root_images_;
    double floor_mm_ = 0, floor_displayed_mm_ = 0;  // what encoding costs, summed over the frames kept
};

}  // namespace

void check_scenes(const DatasetRecipe& recipe) {
    std::set<std::string> seen;
    for (const auto& m : recipe.members) {
        bool fresh = seen.insert(m.split).second;
        for (const auto& [list, entry] : m.picked)
            fresh = seen.insert(list + "/" + entry + "/" + m.split).second || fresh;
        if (fresh) low_of(recipe, m, scene_of(recipe, m));
    }
}

bool make_member(const DatasetRecipe& recipe, const DatasetMember& member, const DatasetFolder& to,
                 Places places, const std::string& device, const InterruptGuard& guard) {
    return MemberRun(recipe, member, to, std::move(places), device).compute(guard);
}

}  // namespace wetcurl
