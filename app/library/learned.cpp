// Learned hair in other programs.
#include <wetcurl/learned.h>

#include <algorithm>
#include <optional>

#include "app/engine/learned_hair.h"
#include "app/engine/scene_changes.h"
#include "app/library/calls.h"
#include "base/installed.h"

using namespace wetcurl;

struct wetcurl_hair {
    int threads;
    std::string scene_file;
    Scene scene;
    Groom low;
    std::vector<int> low_places;
    std::optional<LearnedHair> learned;
    long frames = 0;
    bool crops = false;
};

static void check(const wetcurl_low_run& low, const Scene& scene) {
    const int strands = scene.groom.rest.count;
    auto require = [](bool holds, const char* what, int found, const std::string& allowed) {
        if (!holds)
            throw Error(std::string("wetcurl_open: ") + what + ": found " + std::to_string(found) +
                        ", allowed " + allowed);
    };
    require(low.guides >= 0 && low.guides <= strands, "guides", low.guides,
            "0 to " + std::to_string(strands));
    require(low.guides > 0 || (low.stride >= 2 && low.stride <= 1000), "stride", low.stride, "2 to 1000");
    require(low.substeps >= 0 && low.substeps <= 1'000'000, "substeps", low.substeps, "0 to 1000000");
}

wetcurl_hair* wetcurl_open(const char* scene_file, const char* model, const char* device, int threads) {
    return wetcurl_open_from(scene_file, model, device, threads, {.stride = 2, .guides = 0, .substeps = 0});
}

wetcurl_hair* wetcurl_open_from(const char* scene_file, const char* model, const char* device, int threads,
                                wetcurl_low_run low_run) {
    return guarded<wetcurl_hair*>(nullptr, [&] {
        const std::lock_guard alone(opening());
        const int count = threads_of(threads, "wetcurl_open");
        const Threads own(count);
        Scene scene = load_scene(found_or_installed(given(scene_file, "wetcurl_open", "scene")));
        check(low_run, scene);
        if (scene.saturation.empty())
            throw Error(std::string(scene_file) +
                        ": has no [wetness], which is what the network predicts for");
        if (scene.flow)
            throw Error(std::string(scene_file) +
                        ": its water moves ([wetness.flow]), allowed is wetness that stays");
        std::vector<int> places;
        Groom low =
            low_resolution_of(scene, {.each = low_run.stride, .guides = low_run.guides}, &places).groom;
        const int substeps = low_run.substeps ? low_run.substeps : scene.integrator.substeps;
        auto learned = learned_strands_of(found_or_installed(given(model, "wetcurl_open", "model")), scene,
                                          scene_file, low, 1 / (scene.fps * substeps),
                                          given(device, "wetcurl_open", "device"), count);
        const bool clumps = learned->card().target != "displayed" && scene.cohesion;
        if (clumps && scene.has_deforming_solid())
            throw Error(std::string(scene_file) +
                        ": its solids deform, which cohesion after a network cannot follow here");
        auto hair = std::make_unique<wetcurl_hair>(
            wetcurl_hair{count, scene_file, std::move(scene), std::move(low), std::move(places), {}});
        hair->learned.emplace(std::move(learned), hair->scene, device, clumps);
        return hair.release();
    });
}

void wetcurl_close(wetcurl_hair* hair) { delete hair; }

int wetcurl_low_strands(const wetcurl_hair* hair) { return hair->low.rest.count; }
int wetcurl_high_strands(const wetcurl_hair* hair) { return hair->scene.groom.rest.count; }
int wetcurl_particles(const wetcurl_hair* hair) { return hair->low.rest.particles; }
void wetcurl_low_at_rest(const wetcurl_hair* hair, float* low) {
    for (const Vec3f& p : hair->low.rest.points) *low++ = p.x, *low++ = p.y, *low++ = p.z;
}

void wetcurl_low_places(const wetcurl_hair* hair, int* places) {
    std::copy(hair->low_places.begin(), hair->low_places.end(), places);
}

int wetcurl_crop(wetcurl_hair* hair) {
    return status_of([&] {
        hair->learned->strands().crop(wet_strands_of(hair->scene));
        hair->crops = true;
    });
}

int wetcurl_locks(wetcurl_hair* hair, int passes) {
    return status_of([&] {
        if (passes < 1 || passes > 1000)
            throw Error("wetcurl_locks: passes: found " + std::to_string(passes) + ", allowed 1 to 1000");
        if (hair->learned->is_bound())
            throw Error("wetcurl_locks: the hair is bound; wetcurl_locks comes before wetcurl_bind");
        hair->learned->draw_together(hair->scene, hair->scene_file, passes);
    });
}

int wetcurl_bind(wetcurl_hair* hair, const float* low, float* high, int on_device) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    return status_of([&] {
        if (!low || !high) throw Error("wetcurl_bind: found NULL, allowed memory for the strands");
        hair->learned->bind(reinterpret_cast<const Vec3f*>(low), reinterpret_cast<Vec3f*>(high),
                            on_device != 0);
    });
}

int wetcurl_run(wetcurl_hair* hair, const double before[7], const double now[7], const double after[7]) {
    return status_of([&] {
        if (!hair->learned->is_bound())
            throw Error("wetcurl_run: nothing is bound; wetcurl_bind comes first");
        given(now, "wetcurl_run", "the pose now");
        const Threads own(hair->threads);
        HeadWindow heads;
        heads.fps = hair->scene.fps, heads.gravity = hair->scene.integrator.gravity;
        heads.now = pose_of(now);
        heads.inner = before && after;
        heads.before = before ? pose_of(before) : heads.now;
        heads.after = after ? pose_of(after) : heads.now;
        hair->learned->run(heads, double(hair->frames) / hair->scene.fps);
        ++hair->frames;
    });
}

int wetcurl_expected_errors(wetcurl_hair* hair, float* errors) {
    static_assert(WETCURL_ERROR_PIECES == error_pieces);
    return status_of([&] {
        if (!errors) throw Error("wetcurl_expected_errors: found NULL, allowed memory for the errors");
        if (!hair->frames) throw Error("wetcurl_expected_errors: no frame is run; wetcurl_run comes first");
        if (hair->crops)
            throw Error(
                "wetcurl_expected_errors: found a crop, beyond which nothing is known; open the hair anew");
        const std::vector<float> found = hair->learned->strands().expected_errors();
        std::copy(found.begin(), found.end(), errors);
    });
}

void wetcurl_restart(wetcurl_hair* hair) {
    hair->learned->strands().restart();
    hair->frames = 0;
}
