// Learned hair in other programs.
#include <wetcurl/learned.h>

#include <optional>

#include "app/engine/learned_hair.h"
#include "app/library/calls.h"
#include "base/installed.h"

using namespace wetcurl;

struct wetcurl_hair {
    int threads;
    Scene scene;
    Groom low;
    std::optional<LearnedHair> learned;
    long frames = 0;
};

wetcurl_hair* wetcurl_open(const char* scene_file, const char* model, const char* device, int threads) {
    return guarded<wetcurl_hair*>(nullptr, [&] {
        const std::lock_guard alone(opening());
        const int count = threads_of(threads, "wetcurl_open");
        const Threads own(count);
        Scene scene = load_scene(found_or_installed(given(scene_file, "wetcurl_open", "scene")));
        if (scene.saturation.empty())
            throw Error(std::string(scene_file) +
                        ": has no [wetness], which is what the network predicts for");
        if (scene.flow)
            throw Error(std::string(scene_file) +
                        ": its water moves ([wetness.flow]), allowed is wetness that stays");
        Groom low = coarsened(scene.groom, 2);
        auto learned = learned_strands_of(found_or_installed(given(model, "wetcurl_open", "model")), scene,
                                          scene_file, low, 1 / (scene.fps * scene.integrator.substeps),
                                          given(device, "wetcurl_open", "device"), count);
        const bool clumps = learned->card().target != "displayed" && scene.cohesion;
        if (clumps && scene.has_deforming_solid())
            throw Error(std::string(scene_file) +
                        ": its solids deform, which cohesion after a network cannot follow here");
        auto hair = std::make_unique<wetcurl_hair>(wetcurl_hair{count, std::move(scene), std::move(low), {}});
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

int wetcurl_crop(wetcurl_hair* hair) {
    return status_of([&] { hair->learned->strands().crop(wet_strands_of(hair->scene)); });
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

void wetcurl_restart(wetcurl_hair* hair) {
    hair->learned->strands().restart();
    hair->frames = 0;
}
