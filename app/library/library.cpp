// The library that other programs link.
#include <omp.h>
#include <wetcurl/wetcurl.h>

#include <cmath>
#include <optional>

#include "app/engine/learned_hair.h"
#include "base/error.h"
#include "base/installed.h"

using namespace wetcurl;

struct wetcurl_hair {
    int threads;
    Scene scene;
    Groom low;
    std::optional<LearnedHair> learned;
    long frames = 0;
};

namespace {

thread_local std::string last_error;

// What `act` returns, or `otherwise` where it throws.
template <class Value, class Act>
Value guarded(Value otherwise, Act act) noexcept {
    try {
        last_error.clear();
        return act();
    } catch (const std::exception& e) {
        last_error = e.what();
    } catch (...) {
        last_error = "an error of no known kind";
    }
    return otherwise;
}

constexpr int most_threads = 4096;

// Of OpenMP in the caller's thread, which has its own number back afterwards.
class Threads {
  public:
    explicit Threads(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(count); }
    ~Threads() { omp_set_num_threads(before_); }
    Threads(const Threads&) = delete;

  private:
    int before_;
};

Pose pose_of(const double* p) {
    for (int k = 0; k < 7; ++k)
        if (!std::isfinite(p[k]))
            throw Error("pose: number " + std::to_string(k) + " of 7 is not finite (x y z, then w x y z)");
    const Quatd q{p[3], p[4], p[5], p[6]};
    const double size = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    if (!(std::abs(size - 1) < 1e-3))
        throw Error("pose: found a quaternion of length " + std::to_string(std::sqrt(size)) +
                    ", allowed 1 (x y z, then w x y z)");
    return {normalized(q), {p[0], p[1], p[2]}};
}

const char* text_of(const char* text, const char* what) {
    if (!text) throw Error(std::string("wetcurl_open: ") + what + " is NULL");
    return text;
}

}  // namespace

const char* wetcurl_error(void) { return last_error.c_str(); }

wetcurl_hair* wetcurl_open(const char* scene_file, const char* model, const char* device, int threads) {
    return guarded<wetcurl_hair*>(nullptr, [&] {
        if (threads < 0 || threads > most_threads)
            throw Error("wetcurl_open: found " + std::to_string(threads) + " threads, allowed 0 to " +
                        std::to_string(most_threads));
        const int count = threads > 0 ? threads : omp_get_num_procs();
        const Threads own(count);
        Scene scene = load_scene(found_or_installed(text_of(scene_file, "scene")));
        if (scene.saturation.empty())
            throw Error(std::string(scene_file) +
                        ": has no [wetness], which is what the network predicts for");
        if (scene.flow)
            throw Error(std::string(scene_file) +
                        ": its water moves ([wetness.flow]), allowed is wetness that stays");
        Groom low = coarsened(scene.groom, 2);
        auto learned = learned_strands_of(found_or_installed(text_of(model, "model")), scene, scene_file, low,
                                          text_of(device, "device"), count);
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
    return guarded(-1, [&] {
        hair->learned->strands().crop(wet_strands_of(hair->scene));
        return 0;
    });
}

int wetcurl_bind(wetcurl_hair* hair, const float* low, float* high, int on_device) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    return guarded(-1, [&] {
        if (!low || !high) throw Error("wetcurl_bind: found NULL, allowed memory for the strands");
        hair->learned->bind(reinterpret_cast<const Vec3f*>(low), reinterpret_cast<Vec3f*>(high),
                            on_device != 0);
        return 0;
    });
}

int wetcurl_run(wetcurl_hair* hair, const double before[7], const double now[7], const double after[7]) {
    return guarded(-1, [&] {
        if (!hair->learned->is_bound())
            throw Error("wetcurl_run: nothing is bound; wetcurl_bind comes first");
        if (!now) throw Error("wetcurl_run: the pose now is NULL");
        const Threads own(hair->threads);
        HeadWindow heads;
        heads.fps = hair->scene.fps, heads.gravity = hair->scene.integrator.gravity;
        heads.now = pose_of(now);
        heads.inner = before && after;
        heads.before = before ? pose_of(before) : heads.now;
        heads.after = after ? pose_of(after) : heads.now;
        hair->learned->run(heads, double(hair->frames) / hair->scene.fps);
        ++hair->frames;
        return 0;
    });
}

void wetcurl_restart(wetcurl_hair* hair) {
    hair->learned->strands().restart();
    hair->frames = 0;
}
