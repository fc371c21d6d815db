// The device's steps run on the host by a team of one, against the reference passes.

#include "cuda/adhesion/adhesion_kernel_body.h"
#include "cuda/chain/chain_setup.h"
#include "solver/chain/chain_state.h"
#include "tests/cuda/dense_adhesion.h"
#include "tests/cuda/host_team.h"
#include "tests/solver/characters.h"
#include "tests/solver/one_strand.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

// A scene in the host's memory, and its motion over some frames.
template <class T>
struct OnHost {
    const Scene& scene;
    ChainState<T> state;
    StrandMemory<T> memory{};
    ChainConstants<T> constants;
    std::vector<ShapeView> shapes;
    std::vector<SubstepMotion<T>> motion;
    std::vector<DeviceSolid<T>> solids;
    std::vector<std::vector<RootMotion<T>>> roots;  // (substep, strand) of roots that ride

    OnHost(const Scene& s, int frames)
        : scene(s), state(s), constants(chain_constants<T>(s, 1 / (s.fps * s.integrator.substeps))) {
        memory.n = state.n, memory.strands = state.strands;
        for_each_strand_array([](auto, auto& to, auto& array) { to = array.data(); }, memory, state);
        const size_t substeps = size_t(frames * scene.integrator.substeps);
        const double dt = 1 / (scene.fps * scene.integrator.substeps);
        for (const auto& solid : scene.solids) shapes.push_back(view_of(solid.shape));
        solids.resize(substeps * shapes.size());
        for (size_t k = 0; k < substeps; ++k) {
            DeviceSolid<T>* const of_substep = solids.data() + k * shapes.size();
            PosedScene<T> posed = posed_scene_at<T>(scene, double(k + 1) * dt, dt);
            motion.push_back(substep_motion(posed, shapes.data(), nullptr, of_substep));
            motion[k].solids = of_substep;
            motion[k].roots = roots.emplace_back(std::move(posed.roots)).data();
        }
    }
    Strands strands() const {
        Strands out(state.strands, state.n);
        for (size_t k = 0; k < out.points.size(); ++k) out.points[k] = cast<float>(memory.x[k]);
        return out;
    }
};

// Substeps from `begin` to before `end`.
template <class T, class Set, class Who = OneAlone>
void step(OnHost<T>& host, const Set& set, size_t begin, size_t end, Who who = {}) {
    const auto& m = host.memory;
    const bool limits = host.scene.template term<StrainLimit>().has_value();
    constexpr int together = 3;
    std::vector<StrandFlags> flags(together);
    struct alignas(32) Aligned {
        T numbers[32 / sizeof(T)];
    };
    std::vector<Aligned> workspace(strand_workspace<T>(m.n, together, limits) * sizeof(T) / 32 + 1);
    for (int first = 0; first < m.strands; first += together)
        as_a_team(who, [&]<class Barrier>(const ThreadTeam<Barrier>& team) {
            StrandStep<T, Set, Barrier> strands(m, host.constants, set, team, first,
                                                std::min(together, m.strands - first), workspace[0].numbers,
                                                flags.data());
            strands.load();
            for (size_t k = begin; k < end; ++k) strands.step(host.motion[k], k == 0);
            strands.store();
        });
}
template <class T, class Set, class Who = OneAlone>
Strands stepped(const Scene& scene, const Set& set, int frames, Who who = {}) {
    OnHost<T> host(scene, frames);
    step(host, set, 0, host.motion.size(), who);
    return host.strands();
}

// With a network in Eq 11's place, asked before each substep where all is when it begins.
template <class T>
Strands stepped_with(const DenseLayers& network, const Scene& scene, int frames) {
    OnHost<T> host(scene, frames);
    StrandMemory<T>& m = host.memory;
    const size_t count = host.state.x.size();
    std::vector<T> phi(count), answer(count, T(0));
    std::vector<Vec3<T>> normal(count), velocity(count);
    std::vector<float> before(count);
    m.given_adhesion = answer.data(), m.given_phi = phi.data();
    m.given_normal = normal.data(), m.given_surface_velocity = velocity.data();
    const AdhesionKernelBody<T> bodies{AdhesionFeatures(*scene.term<Adhesion>()),
                                       network.view(network.numbers().data()),
                                       {phi.data(), normal.data(), velocity.data(), m.touching},
                                       answer.data(),
                                       before.data()};
    std::vector<DeviceSolid<T>> solids(host.shapes.size());
    SubstepMotion<T> motion = substep_motion(posed_scene_at<T>(scene, 0, double(host.constants.dt)),
                                             host.shapes.data(), nullptr, solids.data());
    motion.solids = solids.data();
    for (size_t k = 0; k < host.motion.size(); ++k) {
        for (uint32_t i = 0; i < count; ++i) bodies.see(i, m, motion);
        for (uint32_t i = 0; i < count; ++i) bodies.ask(i, m);
        step(host, AnySet{set_of(scene, true)}, k, k + 1);
        motion = host.motion[k];
    }
    return host.strands();
}

struct Case {
    const char* name;
    std::string text;
    std::vector<std::string> set;
};
std::vector<Case> cases() {
    const std::string bare = dry_scene.substr(0, dry_scene.find("[bend]"));
    return {{"dry", dry_scene, {}},
            {"without twist", dry_scene, {"bend.torsion=0"}},
            {"without core", dry_scene.substr(0, dry_scene.find("[core]")), {}},
            {"without bend", bare + "[core]\n", {}},
            {"wet", wet_scene, {}},
            {"stretch alone", bare, {}},
            {"limited", wet_scene, {"integrator.limiter=0.02", "stretch.stiffness=0.05"}},
            {"printed",
             wet_scene,
             {"bend.form='printed'", "core.form='printed'", "curl.form='printed'", "curl.radius=0.008",
              "curl.pitch=0.02"}},
            {"fibre", as_fibre(dry_scene), {}},
            {"fibre without twist", as_fibre(dry_scene), {"fibre.shear_modulus=0"}},
            {"wet fibre", as_fibre(wet_scene), {}},
            {"attached", wet_scene + "[[solid]]\nradius = 0.097\nattached = \"head\"\n", {}},
            {"several solids",
             wet_scene + "[[solid]]\nshape = \"capsule\"\nradius = 0.03\n[[solid.motion.keyframe]]\n"
                         "translation = [0, 0, -0.1]\n[[solid]]\nshape = \"box\"\nhalf = [0.02, 0.05, 0.02]\n"
                         "[[solid.motion.keyframe]]\ntranslation = [0.05, 0, -0.12]\n",
             {"groom.grid=[6, 6]"}}};
}

// Systems of random positive definite elements, of every length, of which one is not to be solved: A x = r
// for rows 2 .. n-1, whatever the first two are known to be.
TEST(StrandSystem, solves_every_length) {
    Random random(3);
    auto matrix = [&] { return Mat3<double>{random.vector(1), random.vector(1), random.vector(1)}; };
    for (int n = 2; n < 70; ++n) {
        struct alignas(32) Aligned {
            double numbers[4];
        };
        const size_t particles = size_t(n), numbers = size_t(StrandSystem<double>::numbers_of(n, 2));
        std::vector<Aligned> workspace(numbers / 4, Aligned{1e300, 1e300, 1e300, 1e300});
        const StrandSystem<double> system(n, workspace[0].numbers);
        std::vector<Element<double>> elements(particles);
        for (int j = 2; j < n; ++j)
            for (int l = 0; l < 3; ++l) {
                Element<double>& e = elements[size_t(j)];
                e.diagonal[l] = isotropic_plus_outer(8.0, 1.0, random.vector(1));
                e.force[l] = random.vector(1);
                if (l < 2) e.upper1[l] = matrix();
                if (l < 1) e.upper2[l] = matrix();
            }
        for (int strand : {0, 1}) {
            for (int k = 0; k < 4; ++k) system.clear(strand, k);
            std::vector<bool> seen(particles, false);
            for (int k = 0; k < system.jobs(); ++k) {
                const int j = system.element_of(k);
                if (j >= n) continue;
                EXPECT_FALSE(seen[size_t(j)]);
                seen[size_t(j)] = true;
                for (int turn = 0; turn < 3; ++turn) system.add(strand, j, turn, elements[size_t(j)]);
            }
            EXPECT_EQ(std::count(seen.begin(), seen.end(), true), n - 2);
        }
        const Vec3d known[2] = {random.vector(1), random.vector(1)};
        std::vector<Vec3d> left(particles), x(particles);
        for (int i = 0; i < n; ++i) {
            Vec3d& right = system.right(1, i);
            right = i < 2 ? known[i] : 0.5 * system.gathered(1, i);
            if (i > 1 && i < 4) right -= system.known_part(1, i, known[0], known[1]);
            if (i > 1) system.add_diagonal(1, i, identity_times(0.1));
        }
        const Vec3d untouched = system.right(0, n - 1);
        system.solve(ThreadTeam<Alone>(Alone(), 0, 1), 2, [](int strand) { return strand == 1; });
        EXPECT_EQ(norm(system.right(0, n - 1) - untouched), 0);
        for (int i = 0; i < n; ++i) x[size_t(i)] = system.right(1, i);
        for (int i = 2; i < n; ++i) left[size_t(i)] = 0.1 * x[size_t(i)];
        for (int j = 2; j < n; ++j) {
            const Element<double>& e = elements[size_t(j)];
            const size_t k = size_t(j);
            for (size_t l = 0; l < 3; ++l)
                left[k - 2 + l] += to_mat3(e.diagonal[l]) * x[k - 2 + l] - 0.5 * e.force[l];
            for (size_t l = 0; l < 2; ++l) {
                left[k - 2 + l] += e.upper1[l] * x[k - 1 + l];
                left[k - 1 + l] += transposed_times(e.upper1[l], x[k - 2 + l]);
            }
            left[k - 2] += e.upper2[0] * x[k];
            left[k] += transposed_times(e.upper2[0], x[k - 2]);
        }
        for (int i = 2; i < n; ++i) EXPECT_LT(norm(left[size_t(i)]), 1e-13) << "row " << i << " of " << n;
    }
}

TEST(StrandStep, does_what_the_reference_passes_do) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        const Strands wanted = after(scene, 4, "double").positions;
        ASSERT_GT(farthest(wanted, scene.groom.rest), 1e-3) << c.name;
        // The whip of a chain without bends magnifies rounding.
        EXPECT_LT(farthest(stepped<double>(scene, AnySet{set_of(scene)}, 4), wanted), 1e-6) << c.name;
    }
}

// Without the solid: a level set that moves is not here.
TEST(StrandStep, of_roots_that_ride_does_what_the_reference_passes_do) {
    const Scratch scratch;
    const Warp twists = [](const Vec3d& x, double time) {
        const double turn = 3 * time * x.y / 0.1;
        return rotate(rotation_about({0, 1, 0}, turn), x) + Vec3d{0.4 * time, 0.3 * time * x.x, 0};
    };
    Scene scene = scene_of("[groom]\nscalp = \"body\"\n" + wet_scene.substr(wet_scene.find("grid")) +
                               "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nattached = \"head\"\n" +
                               mesh_keyframes(scratch, triangulated(Sphere{0.095}, 48), twists, 24, 6),
                           {"stiffness.wet=4"});
    scene.solids.clear(), scene.term<Adhesion>().reset();
    const AnySet set{set_of(scene)};
    ASSERT_TRUE(set.has(present::riding));
    const Strands wanted = after(scene, 4, "double").positions;
    ASSERT_GT(farthest(wanted, scene.groom.rest), 1e-2);
    EXPECT_LT(farthest(stepped<double>(scene, set, 4), wanted), 1e-6);
    EXPECT_LT(farthest(stepped<double>(scene, set, 4, ManyThreads()), wanted), 1e-6);
}

// Their chunks are of more edges.
TEST(StrandStep, of_long_strands_does_what_the_reference_passes_do) {
    for (const char* particles : {"groom.particles=197", "groom.particles=330"}) {
        const Scene scene = scene_of(dry_scene, {"groom.grid=[2, 2]", particles});
        const Strands wanted = after(scene, 2, "double").positions;
        ASSERT_GT(farthest(wanted, scene.groom.rest), 1e-4) << particles;
        EXPECT_LT(farthest(stepped<double>(scene, AnySet{set_of(scene)}, 2), wanted), 1e-6) << particles;
    }
}

// As a block of threads does, but for its speed.
TEST(StrandStep, of_many_threads_does_what_one_alone_does) {
    for (const char* particles : {"groom.particles=28", "groom.particles=29"})
        for (const auto& c : cases()) {
            auto settings = c.set;
            settings.insert(settings.end(), {"groom.grid=[2, 2]", particles});
            const Scene scene = scene_of(c.text, settings);
            const AnySet set{set_of(scene)};
            const Strands alone = stepped<double>(scene, set, 1);
            ASSERT_GT(farthest(alone, scene.groom.rest), 1e-5) << c.name;
            EXPECT_LT(farthest(stepped<double>(scene, set, 1, ManyThreads()), alone), 1e-9)
                << c.name << ' ' << particles;
        }
}

TEST(StrandStep, with_a_network_does_what_the_cpu_does_with_it) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        if (!scene.term<Adhesion>()) continue;
        DenseAdhesion model(5);
        const auto cpu = make_simulation(scene, "double");
        cpu->use_adhesion_predictor(&model);
        const int frames = c.name == std::string("several solids") ? 1 : 5;
        for (int f = 0; f < frames; ++f) cpu->advance();
        RunFrame wanted;
        cpu->snapshot(wanted);
        ASSERT_GT(model.asked, 500u) << c.name;
        ASSERT_GT(farthest(wanted.positions, after(scene, frames, "double").positions), 1e-4) << c.name;
        EXPECT_LT(farthest(stepped_with<double>(model.all, scene, frames), wanted.positions), 1e-6) << c.name;
    }
}

TEST(StrandStep, of_a_set_known_at_compile_time_is_the_general_one) {
    using namespace present;
    const Scene scene = scene_of(dry_scene);
    constexpr unsigned set = these<Stretch, Bend, Twist, Core>;
    ASSERT_EQ(set_of(scene), set);
    EXPECT_LT(farthest(stepped<double>(scene, ExactSet<set>(), 3), stepped<double>(scene, AnySet{set}, 3)),
              1e-7);
    const Scene fibres = scene_of(as_fibre(dry_scene));
    constexpr unsigned of_fibres = these<Stretch, Bend, Twist> | 1u << fibre;
    ASSERT_EQ(set_of(fibres), of_fibres);
    EXPECT_LT(farthest(stepped<double>(fibres, ExactSet<of_fibres>(), 3),
                       stepped<double>(fibres, AnySet{of_fibres}, 3)),
              1e-7);
}

TEST(StrandStep, in_single_precision_stays_near_the_double_one) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        const AnySet set{set_of(scene)};
        // Hair that sticks and lets go, is limited or loses its bend swings chaotically; in a crease of
        // solids a strand may come out on the other side.
        const bool smooth = c.name == std::string("dry");
        const int frames = smooth ? 24 : 1;
        const int astray = strands_astray(stepped<float>(scene, set, frames),
                                          stepped<double>(scene, set, frames), smooth ? 1e-5 : 5e-4);
        EXPECT_LE(astray, c.name == std::string("several solids") ? 4 : 0) << c.name;
    }
}

}  // namespace
}  // namespace wetcurl
