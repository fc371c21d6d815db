// The scenes that the project ships: each is a letter to its reader, is read, and takes its first step.
#include <fstream>

#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

class ShippedScene : public ::testing::TestWithParam<std::string> {
  protected:
    std::string path() const { return shipped_scene(GetParam()); }
};

TEST_P(ShippedScene, begins_with_what_it_shows) {
    std::ifstream in(path());
    std::string line;
    std::getline(in, line);
    EXPECT_TRUE(line.starts_with("# ") && line.size() > 20) << line;
}

TEST_P(ShippedScene, takes_its_first_step_wet_and_dry) {
    SceneOptions options;
    options.set = {"integrator.settle=0"};
    options.strands = 64;
    Scene scene = load_scene(path(), options);
    for (const bool dry : {false, true}) {
        if (dry) make_dry(scene);
        const RunFrame frame = after(scene, 1);
        ASSERT_EQ(frame.positions.points.size(), scene.groom.rest.points.size());
        for (const Vec3f& x : frame.seen().points) ASSERT_TRUE(std::isfinite(norm(x)));
        const double moved = farthest(frame.positions, scene.groom.rest);
        EXPECT_LT(moved, 1);  // [m]
        if (norm(scene.integrator.gravity) > 0) {
            EXPECT_GT(moved, 1e-6);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene, ::testing::ValuesIn(shipped_scenes()),
                         [](const auto& about) { return about.param; });

}  // namespace
}  // namespace wetcurl
