// A network in Eq 11's place as a device asks it, run on the host, particle by particle, against
// AdhesionNetworkCoupling.
#include <gtest/gtest.h>

#include "cuda/adhesion/adhesion_kernel_body.h"
#include "cuda/chain/chain_setup.h"
#include "solver/chain/chain_state.h"
#include "tests/cuda/dense_adhesion.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double dt = 1.0 / 96;

// The ball moves, and so does one that reaches all strands as a level set.
std::string balls(const Scratch& scratch) {
    scratch.file("ball.obj", obj_of(triangulated(Sphere{0.09}, 32)));
    return wet_scene + "[[solid]]\nshape = \"mesh\"\nfile = \"" + scratch.path("ball.obj") +
           "\"\nspacing = 0.01\n[[solid.motion.keyframe]]\ntranslation = [0, -0.05, 0]\n"
           "[[solid.motion.keyframe]]\ntime = 0.1\ntranslation = [0, -0.03, 0.02]\n";
}

// A state as some of a run's substeps might have it: strands move, some are dry, and some touch.
template <class T>
void stir(ChainState<T>& state, Random& random) {
    for (size_t k = 0; k < state.x.size(); ++k) {
        state.x[k] += cast<T>(random.vector(0.004)), state.v[k] = cast<T>(random.vector(0.5));
        state.touching[k] = random.number() > 0;
        state.saturation[k] = k / size_t(state.n) == 2 ? T(0) : T(std::max(random.number(-0.2, 1), 0.0));
    }
}

template <class T>
void expect_the_references(const Scene& scene, T bound) {
    const DenseAdhesion model(4);
    ChainState<T> state(scene);
    const size_t count = state.x.size();
    NearestSurface<T> wanted{std::vector<T>(count, T(1e9)), std::vector<Vec3<T>>(count, {0, 1, 0}),
                             std::vector<Vec3<T>>(count, {0, 0, 0})};
    AdhesionNetworkCoupling<T> reference;
    DenseAdhesion asked = model;
    reference.model = &asked;

    std::vector<ShapeView> shapes;
    for (const auto& solid : scene.solids) shapes.push_back(view_of(solid.shape));
    StrandMemory<T> memory{};
    memory.n = state.n, memory.strands = state.strands;
    for_each_strand_array([](auto, auto& to, auto& array) { to = array.data(); }, memory, state);
    std::vector<T> phi(count, T(NAN)), answer(count, T(0));
    std::vector<Vec3<T>> normal(count), velocity(count);
    std::vector<float> before(count, NAN);
    const AdhesionKernelBody<T> bodies{AdhesionFeatures(*scene.term<Adhesion>()),
                                       model.all.view(model.all.numbers().data()),
                                       {phi.data(), normal.data(), velocity.data(), state.touching.data()},
                                       answer.data(),
                                       before.data()};
    Random random(8);
    for (int substep = 0; substep < 5; ++substep) {
        stir(state, random);
        const auto p = posed_scene_at<T>(scene, substep * dt, dt);
        for (size_t k = 0; k < count; k += size_t(state.n))
            sample_nearest(p, state.n, &state.x[k], &wanted.phi[k], &wanted.normal[k], &wanted.velocity[k]);
        reference.evaluate(*scene.term<Adhesion>(), state, wanted);

        std::vector<DeviceSolid<T>> solids(shapes.size());
        SubstepMotion<T> motion = substep_motion(p, shapes.data(), nullptr, solids.data());
        motion.solids = solids.data();
        // Backwards: a pass reads nothing that it writes for another.
        for (uint32_t k = uint32_t(count); k-- > 0;) bodies.see(k, memory, motion);
        for (uint32_t k = uint32_t(count); k-- > 0;) bodies.ask(k, memory);

        int pulled = 0, idle = 0;
        T most = 0;
        for (size_t k = 0; k < count; ++k) {
            EXPECT_NEAR(answer[k], reference.given()[k], bound) << k;
            EXPECT_EQ(answer[k] == 0, reference.given()[k] == 0) << k;
            EXPECT_NEAR(phi[k], wanted.phi[k], 1e-7) << k;
            EXPECT_LT(norm(normal[k] - wanted.normal[k]), T(1e-5)) << k;
            EXPECT_LT(norm(velocity[k] - wanted.velocity[k]), T(1e-5)) << k;
            pulled += answer[k] != 0, idle += answer[k] == 0;
            most = std::max(most, std::abs(answer[k]));
        }
        EXPECT_GT(pulled, 50);
        EXPECT_GT(idle, 50);
        EXPECT_GT(most, 0.1);
    }
    EXPECT_GT(asked.asked, 500u);
}

TEST(AdhesionKernelBody, answer_as_the_reference_over_substeps) {
    const Scratch scratch;
    for (const std::string& text : {wet_scene, balls(scratch)}) {
        const Scene scene = scene_of(text);
        ASSERT_EQ(scene.solids.size(), text == wet_scene ? 1u : 2u);
        // Roundings of inputs near one, through four layers.
        expect_the_references<double>(scene, 1e-6);
        expect_the_references<float>(scene, 1e-5f);
    }
}

TEST(AdhesionKernelBody, a_network_with_other_inputs_is_refused) {
    struct Narrow : AdhesionPredictor {
        DenseLayers all{{3, 1}, std::vector<float>(4)};
        void evaluate(const float*, size_t, float*) override {}
        const DenseLayers* layers() const override { return &all; }
    } narrow;
    AdhesionNetworkCoupling<double> network;
    EXPECT_EQ(network.layers(), nullptr);
    network.model = &narrow;
    expect_error([&] { network.layers(); }, {"3 inputs", "12"});
    DenseAdhesion dense(1);
    network.model = &dense;
    EXPECT_EQ(network.layers(), &dense.all);
    // What is written down for training, the host asks.
    std::vector<AdhesionRecord> records;
    network.records = &records;
    EXPECT_EQ(network.layers(), nullptr);
}

}  // namespace
}  // namespace wetcurl
