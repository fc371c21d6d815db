// A run that goes on from a state is, to the bit, the run that was never broken: walked over all shipped
// scenes.
#include <cmath>

#include "tests/solver/characters.h"

namespace wetcurl {
namespace {

using namespace testing;

bool same_points(const Strands& a, const Strands& b) {
    return a.count == b.count && a.particles == b.particles &&
           std::equal(a.points.begin(), a.points.end(), b.points.begin(),
                      [](const Vec3f& p, const Vec3f& q) { return p.x == q.x && p.y == q.y && p.z == q.z; });
}

// All of a frame but its run times.
void expect_same(const RunFrame& a, const RunFrame& b) {
    EXPECT_TRUE(same_points(a.positions, b.positions));
    EXPECT_TRUE(same_points(a.displayed, b.displayed));
    EXPECT_EQ(a.energy, b.energy);
    EXPECT_EQ(a.contact, b.contact);
    EXPECT_EQ(a.saturation, b.saturation);
    EXPECT_EQ(a.water, b.water);
    EXPECT_EQ(norm(a.head.translation - b.head.translation), 0);
    EXPECT_EQ(a.head.rotation.w, b.head.rotation.w);
}

// The network's stand-in: an answer that depends on the answers before it.
class Echo final : public AdhesionPredictor {
  public:
    void evaluate(const float* inputs, size_t count, float* outputs) override {
        for (size_t k = 0; k < count; ++k) {
            const float* of = inputs + k * AdhesionFeatures::inputs + AdhesionChannels::first(0);
            outputs[k] = 0.5f * of[AdhesionChannels::force] - 0.2f;
            pulled_ += of[AdhesionChannels::force] != 0;
        }
    }
    long pulled() const { return pulled_; }

  private:
    long pulled_ = 0;
};

// Frames after `broken_at` of a run, and of another one that goes on from its state there, without what comes
// before frame 0.
void expect_to_go_on(const Scene& scene, const std::string& precision, int broken_at, int frames,
                     AdhesionPredictor* network = nullptr) {
    Scene at_once = scene;
    at_once.integrator.settle = at_once.preroll = 0;
    const auto whole = make_simulation(scene, precision), second = make_simulation(at_once, precision);
    for (const auto& simulation : {whole.get(), second.get()}) simulation->use_adhesion_predictor(network);
    for (int f = 0; f < broken_at; ++f) whole->advance();
    const RunState state = whole->run_state();
    second->resume(state);
    RunFrame a, b;
    whole->snapshot(a), second->snapshot(b);
    EXPECT_TRUE(same_points(a.displayed, b.displayed));
    for (int f = broken_at; f < frames; ++f) {
        SCOPED_TRACE("frame " + std::to_string(f + 1));
        // Frames that nobody sees do not change those that follow.
        const bool shown = f % 2 == 0 || f + 1 == frames;
        whole->advance(), second->advance(shown);
        if (!shown) continue;
        whole->snapshot(a), second->snapshot(b);
        expect_same(a, b);
    }
    EXPECT_EQ(whole->limited_edges(), second->limited_edges());
}

class ResumedScene : public ::testing::TestWithParam<std::string> {};

TEST_P(ResumedScene, goes_on_to_the_same_bits) {
    SceneOptions options;
    options.set = {"integrator.settle=0", "groom.grid=[6,6]"};
    const Scene scene = load_scene(shipped_scene(GetParam()), options);
    expect_to_go_on(scene, "float", 3, 6);
}

INSTANTIATE_TEST_SUITE_P(All, ResumedScene, ::testing::ValuesIn(shipped_scenes()),
                         [](const auto& about) { return about.param; });

// Strands that do not fill their last block have neighbours there.
TEST(Resume, goes_on_to_the_same_bits_in_contact_in_any_precision_and_step) {
    for (const char* more : {"[strand_contact]\nradius = 0.01\n", "[baseline]\ncohesion = \"lin\"\n"})
        for (const char* precision : {"float", "double"})
            for (int broken_at : {1, 9}) {
                SCOPED_TRACE(std::string(more) + precision + std::to_string(broken_at));
                std::string text = wet_scene + more;
                if (text.find("[baseline]") != std::string::npos) text = without(text, "[cohesion]");
                text.replace(text.find("[4, 4]"), 6, "[3, 5]");
                expect_to_go_on(parse_scene(text, "resumed.toml", "."), precision, broken_at, 12);
            }
}

TEST(Resume, a_network_has_the_answers_of_the_step_before) {
    Echo network;
    expect_to_go_on(parse_scene(wet_scene, "resumed.toml", "."), "float", 6, 9, &network);
    EXPECT_GT(network.pulled(), 100);
}

// Before a cut, at its frame, and after it; roots ride, and settle again at the cut.
TEST(Resume, goes_on_to_the_same_bits_over_cuts_after_a_preroll) {
    const Scratch scratch;
    const Warp jumps = [](const Vec3d& x, double time) {
        return rotate(rotation_about({0, 0, 1}, time), (1 + time) * x) + Vec3d{time < 0.15 ? 0.0 : 3.0, 0, 0};
    };
    std::vector<StandingStrand> strands;
    for (int k = 0; k < 9; ++k) {
        const double y = 0.95 - 0.04 * k, r = std::sqrt(1 - y * y);
        const Vec3d n{r * std::cos(2.4 * k), y, r * std::sin(2.4 * k)};
        strands.push_back({0.1004 * n, n});
    }
    const Mesh ball = triangulated(Sphere{0.1}, 16);
    const std::string rest = scratch.file("rest.obj", obj_of(ball));
    const Scene scene = scene_of(
        "frames = 8\n" + standing(scratch, strands, 0.1, 10, "body") +
        "[integrator]\nsubsteps = 3\nsettle = 0.1\nsettle_after_cut = 0.05\n[stretch]\n[bend]\n[core]\n"
        "[strand_contact]\nradius = 0.01\n[motion]\ncuts = [4]\npreroll = 0.2\n"
        "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.01\nrest = \"" +
        rest + "\"\n" + mesh_keyframes(scratch, ball, jumps, 24, 9));
    ASSERT_TRUE(scene.riding);
    for (int broken_at : {2, 3, 4, 6}) {
        SCOPED_TRACE(broken_at);
        expect_to_go_on(scene, "float", broken_at, 8);
    }
}

// Each thing that is carried matters: without it the run goes on otherwise.
TEST(Resume, air_and_contact_lists_and_water_that_is_counted_are_carried) {
    const std::string air = R"([air]
size = 0.6
grid = [16, 16, 16]
wind = [3, 0, 0]
two_way = true
)";
    const Scene scene = parse_scene(dry_scene + air, "resumed.toml", ".");
    const auto whole = make_simulation(scene, "float"), second = make_simulation(scene, "float");
    for (int f = 0; f < 4; ++f) whole->advance();
    second->restore(whole->state());  // without the air
    whole->advance(), second->advance();
    RunFrame a, b;
    whole->snapshot(a), second->snapshot(b);
    EXPECT_FALSE(same_points(a.positions, b.positions));
    expect_to_go_on(scene, "float", 4, 7);
}

}  // namespace
}  // namespace wetcurl
