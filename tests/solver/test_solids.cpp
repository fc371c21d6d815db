// Solids that deform, and many of them: against analytic spheres, the work that they do, the plain loop.
#include <cstring>

#include "solver/cohesion/display.h"
#include "solver/solids/deforming_solids.h"
#include "solver/solids/posed_scene.h"
#include "solver/stability/trial.h"
#include "tests/base/threads.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

StabilityMethod in_double() { return {"ours", "implicit double", "double", {}, 2, {}, {}}; }

const std::string chain = "[groom]\ngrid = [2, 2]\nparticles = 8\n[stretch]\n";

// --- keyframes

TEST(Deformation, is_linear_between_keys_that_rise_alike_and_smooth_at_all_of_them) {
    const Scratch scratch;
    const Scene scene =
        scene_of(chain + breathing_sphere(scratch, {0.05, 0.06, 0.07, 0.08, 0.06}, 0.25, "[0, 0, 0]", 0.02));
    const Deformation& deformation = *scene.solids.at(0).deformation;
    const auto radius = [&](double time) { return double(norm(deformation.at(time).vertices[7])); };
    for (double t : {0.25, 0.3, 0.41, 0.5}) EXPECT_NEAR(radius(t), 0.06 + 0.04 * (t - 0.25), 2e-8);
    EXPECT_NEAR(radius(7), 0.06, 1e-8);
    for (double key : {0.25, 0.5, 0.75}) {
        const double dt = 1e-3, before = (radius(key) - radius(key - dt)) / dt,
                     after = (radius(key + dt) - radius(key)) / dt;
        EXPECT_NEAR(before, after, 2e-3);  // the bend over dt; a kink would be 0.04 and more
    }
    EXPECT_NEAR(deformation.box().high.y, 0.08, 1e-7);
}

TEST(Solids, a_mesh_without_extent_is_refused_by_the_name_of_its_file) {
    const Scratch scratch;
    const std::string file = scratch.file("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
    expect_error([&] { scene_of(chain + "[[solid]]\nshape = \"mesh\"\nfile = \"" + file + "\"\n"); },
                 {"scene.toml:7: solid[0].file", "point.obj", "has no extent"});
}

TEST(Deformation, says_what_is_wrong_with_its_keyframes) {
    const Scratch scratch;
    const std::string a = scratch.file("a.obj", obj_of(triangulated(Sphere{0.1}, 16))),
                      more = scratch.file("more.obj", obj_of(triangulated(Sphere{0.1}, 20)));
    Mesh turned = triangulated(Sphere{0.1}, 16);
    std::swap(turned.triangles[4][0], turned.triangles[4][1]);
    const std::string other = scratch.file("other.obj", obj_of(turned));
    const auto refuses = [&](const std::string& solid, std::initializer_list<std::string> parts) {
        expect_error<Misuse>([&] { scene_of(chain + "[[solid]]\nshape = \"mesh\"\n" + solid); }, parts);
    };
    const auto key = [](double time, const std::string& file) {
        return "[[solid.mesh]]\ntime = " + std::to_string(time) + "\nfile = \"" + file + "\"\n";
    };
    refuses(key(0, a) + key(1, more), {"scene.toml:12", "more.obj", "triangles", "a.obj", "share"});
    refuses(key(0, a) + key(1, other), {"scene.toml:12", "triangle 5", "other.obj"});
    refuses(key(0, a) + key(1, scratch.path("none.obj")), {"scene.toml:12", "no file", "none.obj"});
    refuses(key(1, a) + key(1, a), {"scene.toml:11", "found 1", "above 1"});
    refuses(key(0, a), {"scene.toml:7", "two or more"});
    refuses("[[solid.mesh]]\n[[solid.mesh]]\ntime = 1\n", {"scene.toml:7", "needs file"});
    refuses("file = \"" + a + "\"\n" + key(0, a) + key(1, a), {"scene.toml:7", "keeps its shape"});
    refuses("file = \"" + scratch.path("none.obj") + "\"\n", {"scene.toml:7", "no file"});
    expect_error<Misuse>(
        [&] {
            scene_of(chain +
                     "[wetness]\n[baseline]\nmethod = \"boundary_particles\"\n[[solid]]\nshape = \"mesh\"\n" +
                     key(0, a) + key(1, a));
        },
        {"rigid"});
}

// --- contact

TEST(DeformingSolid, a_sphere_that_grows_pushes_a_tip_outward) {
    const Scratch scratch;
    const double spacing = 0.006, inset = 0.12;
    StrandSetup setup{{straight_points(16, 0.2, {0, -1, 0})}, 1e4, 1.0 / 24, 0, {0, 0, 0}, 5, "", {}};
    setup.set = {"integrator.substeps=10"};
    setup.more =
        breathing_sphere(scratch, {0.09, 0.11, 0.13, 0.15, 0.17}, 0.25, "[-0.12, -0.2, 0]", spacing, 128);
    Trial trial(in_double(), scene_of(setup, in_double()));
    const Vec3d center{-inset, -0.2, 0};
    double worst = 0, touched = 1;
    for (int f = 1; f <= 18; ++f) {
        trial.advance();
        const double t = f / 24.0, r = 0.11 + 0.08 * (t - 0.25);
        if (t < 0.25 || t > 0.75) continue;  // there the growth is linear
        const auto x = trial.simulation().state().x;
        for (const auto& p : x) worst = std::max(worst, r - norm(p - center));
        touched = std::min(touched, std::abs(norm(x.back() - center) - r));
    }
    std::printf("a sphere that grows by 80 mm/s: a tip lies at most %.3g mm inside it\n", 1000 * worst);
    // The grid's error: h² / (2 r) of interpolation, and facets of 128 corners r pi² / 128² / 2.
    EXPECT_LT(worst, spacing * spacing / (2 * 0.11) + 0.15 * 9.9 / 128 / 128 / 2);
    EXPECT_LT(touched, 2e-3);
    EXPECT_GT(trial.simulation().state().x.back().x, 0.02);
    EXPECT_GT(trial.simulation().work().solids, 0);
}

TEST(DeformingSolid, does_the_work_that_the_energy_of_hair_grows_by) {
    const Scratch scratch;
    for (double friction : {0.0, 0.3}) {
        StrandSetup setup{{straight_points(30, 0.25, {0, -1, 0}), helix_points(30, 0.25, 0.006, 0.025)},
                          1e5,
                          1.0 / 24,
                          0,
                          {0, -9.81, 0},
                          0,
                          "",
                          {}};
        setup.set = {"integrator.substeps=10"};
        setup.more =
            breathing_sphere(scratch, {0.03, 0.07, 0.03, 0.07, 0.03, 0.07}, 0.2, "[0.05, -0.2, 0.01]", 0.008);
        const size_t at = setup.more.find("spacing");
        setup.more.insert(at, "friction = " + std::to_string(friction) + "\n");
        Trial trial(in_double(), scene_of(setup, in_double()));
        double most = 0;
        for (int f = 0; f < 24; ++f) {
            trial.advance();
            most = std::max(most, trial.simulation().work().solids);
        }
        std::printf(
            "breathing sphere, friction %.1f: it gave up to %.3g J; energy less work at most %.2g of it\n",
            friction, most, trial.energy_ratio());
        EXPECT_GT(most, 1e-7);
        EXPECT_LT(trial.energy_ratio(), 1e-3);  // the bound of S2
    }
}

TEST(DeformingSolid, gives_the_same_bits_for_one_and_three_threads) {
    const Scratch scratch;
    const std::string text = dry_scene + "[wetness]\n[adhesion]\n[cohesion]\n" +
                             breathing_sphere(scratch, {0.07, 0.11, 0.08}, 0.1, "[0, 0, 0]", 0.012);
    const Scene scene = scene_of(text);
    const auto [one, three] = with_one_and_three_threads([&] { return after(scene, 4); });
    EXPECT_TRUE(same_bits(one.positions, three.positions));
    EXPECT_TRUE(same_bits(one.displayed, three.displayed));
    EXPECT_GT(farthest(one.positions, after(scene_of(text, {"frames=100"}), 1).positions), 1e-3);
}

TEST(DeformingSolid, has_a_stage_and_buffers_that_other_scenes_lack) {
    const Scratch scratch;
    const Scene with = scene_of(dry_scene + breathing_sphere(scratch, {0.07, 0.11}, 0.1, "[0, 0, 0]", 0.02)),
                without = scene_of(dry_scene + "[[solid]]\n");
    const auto a = make_simulation(with, "float"), b = make_simulation(without, "float");
    a->advance();
    RunFrame frame;
    a->snapshot(frame);
    EXPECT_EQ(a->stages, (std::vector<std::string>{"chain", "level set"}));
    EXPECT_GT(frame.stage_seconds.at(1), 0);
    EXPECT_EQ(b->stages, (std::vector<std::string>{"chain"}));
    for (const auto& buffer : b->buffers()) EXPECT_EQ(buffer.name.find("deforming"), std::string::npos);
    size_t bytes = 0;
    for (const auto& buffer : a->buffers())
        if (buffer.name.find("deforming") != std::string::npos) bytes = buffer.bytes;
    EXPECT_GT(bytes, 10000u);
}

TEST(DeformingSolid, displays_no_hair_inside_and_rests_where_it_is_restored) {
    const Scratch scratch;
    const Scene scene = scene_of(dry_scene + "[wetness]\n[cohesion]\n" +
                                 breathing_sphere(scratch, {0.03, 0.06}, 0.2, "[0, 0, -0.13]", 0.012));
    const auto simulation = make_simulation(scene, "double");
    for (int f = 0; f < 5; ++f) simulation->advance();
    RunFrame frame, again;
    simulation->snapshot(frame);
    DeformingSolids surfaces(scene);
    surfaces.hold(5 / 24.0);
    const Pose pose = scene.solids[0].at(5 / 24.0, frame.head);
    for (int s = 0; s < frame.displayed.count; ++s)
        for (int i = 1; i < frame.displayed.particles; ++i) {
            const Vec3d local = pose.inverse(cast<double>(frame.displayed.at(s, i)));
            EXPECT_GT(distance(*surfaces.at_end(), local).phi, -5e-4);  // one push along the gradient
        }
    simulation->restore(simulation->state());
    simulation->snapshot(again);
    EXPECT_TRUE(same_bits(frame.displayed, again.displayed));
}

TEST(DeformingSolid, attached_has_a_level_set_no_larger_than_hair_reaches) {
    const Scratch scratch;
    for (const char* name : {"a.obj", "b.obj"})
        scratch.file(name, obj_of(triangulated(Capsule{2, 0.08}, 24)));
    const auto of = [&](const std::string& attached) {
        return DeformingSolids(scene_of(chain + "[[solid]]\nshape = \"mesh\"\nspacing = 0.02\n" + attached +
                                        "[[solid.mesh]]\nfile = \"" + scratch.path("a.obj") +
                                        "\"\n[[solid.mesh]]\ntime = 1\nfile = \"" + scratch.path("b.obj") +
                                        "\"\n"))
            .level_sets()[0]
            .nodes();
    };
    EXPECT_LT(of("attached = \"head\"\n"), of("") / 2);
}

// --- many solids

template <class T>
struct ManySolids {
    std::vector<Shape> shapes;
    std::vector<PosedSolid<T>> posed;
};

// Of every shape, some of them twice in one place.
template <class T>
ManySolids<T> random_solids(int count, Random& random) {
    ManySolids<T> out;
    const auto level_set = std::make_shared<const LevelSet>(triangulated(Capsule{0.1, 0.05}, 16), 0.02);
    for (int k = 0; k < count; ++k)
        out.shapes.push_back(k % 5 == 0   ? Shape(Sphere{random.number(0.02, 0.1)})
                             : k % 5 == 1 ? Shape(Capsule{random.number(0.01, 0.2), 0.03})
                             : k % 5 == 2 ? Shape(Box{{0.05, random.number(0.01, 0.1), 0.02}})
                             : k % 5 == 3 ? Shape(level_set)
                             : k < 8      ? Shape(Plane{})
                                          : Shape(Sphere{0.05}));
    for (int k = 0; k < count; ++k) {
        PosedSolid<T> solid{&out.shapes[size_t(k)],
                            cast<T>(random.rotation()),
                            cast<T>(random.vector(0.6) - Vec3d{0, 0.3, 0}),
                            cast<T>(random.vector()),
                            cast<T>(random.vector()),
                            T(random.number(0, 1)),
                            k % 3 == 0};
        if (k % 7 == 6) solid = out.posed[size_t(k - 1)], solid.friction = T(2);
        out.posed.push_back(solid);
    }
    return out;
}

template <class V>
bool same_memory(const V& a, const V& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

template <class S>
void expect_tree_is_loop(unsigned seed) {
    using T = Plain<S>;
    Random random(seed);
    for (int count : {1, 2, 9, 40}) {
        const auto solids = random_solids<T>(count, random);
        SolidTree<T> tree;
        tree.pose(solids.posed);
        size_t visited = 0, asked = 0;
        for (int k = 0; k < 300; ++k) {
            Vec3<S> x;
            const Vec3d about = random.vector(k % 10 == 0 ? 30 : 0.8);
            const auto put = [&](S& to, double a) {
                if constexpr (std::is_same_v<S, T>)
                    to = T(a);
                else
                    for (int lane = 0; lane < S::lanes; ++lane)
                        to.set(lane, T(a + random.number(-0.05, 0.05)));
            };
            put(x.x, about.x), put(x.y, about.y), put(x.z, about.z);
            const Vec3<S> zero{S(0), S(0), S(0)};
            S phi[2];
            Vec3<S> normal[2] = {zero, zero}, velocity[2] = {zero, zero};
            sample_nearest(solids.posed, x, phi[0], normal[0], velocity[0]);
            sample_nearest(tree, solids.posed, x, phi[1], normal[1], velocity[1]);
            EXPECT_TRUE(same_memory(phi[0], phi[1]) && same_memory(normal[0], normal[1]) &&
                        same_memory(velocity[0], velocity[1]));
            const Hold<S> loop = deepest_contact(solids.posed, S(T(-0.01)), x),
                          found = deepest_contact(tree, solids.posed, S(T(-0.01)), x);
            EXPECT_TRUE(same_memory(loop.gap, found.gap) && same_memory(loop.normal, found.normal) &&
                        same_memory(loop.friction, found.friction) &&
                        same_memory(loop.weight, found.weight) && same_memory(loop.drag, found.drag));
            S reach(T(1e9));
            tree.visit_near(x, reach, [&](int s) {
                ++visited, reach = minimum(reach, distance_in_world(solids.posed[size_t(s)], x).phi);
            });
            asked += size_t(count);
        }
        if (count == 40) {
            EXPECT_LT(visited, asked / 2);
        }
    }
}

TEST(SolidTree, finds_what_the_loop_over_all_solids_finds_to_the_bit) {
    expect_tree_is_loop<float>(1);
    expect_tree_is_loop<double>(2);
    expect_tree_is_loop<Pack<float>>(3);
    expect_tree_is_loop<Pack<double>>(4);
}

TEST(SolidTree, meets_every_solid_that_the_loop_pushes_out_of) {
    using S = Pack<float>;
    Random random(5);
    auto solids = random_solids<float>(30, random);
    // So dense that a particle is pushed out of one into others.
    for (auto& solid : solids.posed)
        if (!std::holds_alternative<Plane>(*solid.shape))
            solid.translation = cast<float>(random.vector(0.25));
    SolidTree<float> tree;
    tree.pose(solids.posed);
    constexpr int n = 12;
    int met = 0, asked = 0;
    for (int round = 0; round < 400; ++round) {
        std::vector<Vec3<S>> x(n), v(n, {S(0.1f), S(0), S(0)});
        std::vector<S> mass(n, S(1)), depth(n, S(-0.01f));
        const Vec3d about = random.vector(0.3);
        for (auto& p : x)
            for (int lane = 0; lane < S::lanes; ++lane) {
                const Vec3d q = about + random.vector(0.02);
                p.x.set(lane, float(q.x)), p.y.set(lane, float(q.y)), p.z.set(lane, float(q.z));
            }
        auto go = [&](bool by_tree) {
            auto at = x, at_before = x, speed = v, speed_before = v;
            std::vector<S> pushed(n, S(0));
            const auto meet = [&](size_t k) {
                ++(by_tree ? met : asked);
                return resolve_contact(solids.posed[k], solids.posed[k].friction, n, depth.data(),
                                       static_cast<const S*>(nullptr), 0.01f, mass.data(), pushed.data(),
                                       at.data(), at_before.data(), speed.data(), speed_before.data());
            };
            if (by_tree)
                tree.for_each_met(n, at.data(), meet);
            else
                for (size_t k = 0; k < solids.posed.size(); ++k) meet(k);
            at.insert(at.end(), speed.begin(), speed.end());
            return at;
        };
        const auto loop = go(false), found = go(true);
        EXPECT_EQ(std::memcmp(&loop[2], &found[2], (loop.size() - 2) * sizeof loop[0]), 0);
    }
    EXPECT_LT(met, asked / 2);
}

// Particles wander among solids that fly and turn: who is said to be far has no gap that closes.
TEST(FarFromSolids, are_those_whose_gaps_stay_open) {
    using S = Pack<float>;
    Random random(17);
    constexpr int n = 40, substeps = 30;
    const float dt = 1 / 240.f;
    for (int count : {1, 4, 12}) {
        auto solids = random_solids<float>(count, random);
        std::erase_if(solids.posed, [](const auto& s) { return std::holds_alternative<Plane>(*s.shape); });
        PosedScene<float> p{};
        p.solids = solids.posed, p.dt = dt;
        FarFromSolids<S> far(n);
        std::vector<Vec3<S>> x(n), v(n);
        for (int i = 0; i < n; ++i) {
            const Vec3d about = random.vector(0.8);
            for (int l = 0; l < S::lanes; ++l) {
                const Vec3f at = cast<float>(about + random.vector(0.05)),
                            speed = cast<float>(random.vector(1));
                x[size_t(i)].x.set(l, at.x), x[size_t(i)].y.set(l, at.y), x[size_t(i)].z.set(l, at.z);
                v[size_t(i)].x.set(l, speed.x), v[size_t(i)].y.set(l, speed.y),
                    v[size_t(i)].z.set(l, speed.z);
            }
        }
        int said = 0, near = 0;
        for (int k = 0; k < substeps; ++k) {
            for (auto& solid : p.solids) {
                solid.translation += dt * solid.velocity;
                const Quatd turn = rotation_about(normalized(cast<double>(solid.spin), Vec3d{1, 0, 0}),
                                                  double(dt) * double(norm(solid.spin)));
                solid.rotation = cast<float>(turn) * solid.rotation;
            }
            for (int i = 0; i < n; ++i) {
                Vec3<S>& at = x[size_t(i)];
                at += S(dt) * v[size_t(i)];
                const auto hold = deepest_contact(p.solids, S(0), at);
                const bool is_far = far.is_far(i, at, p);
                if (is_far) {
                    EXPECT_FALSE(any_positive(-hold.gap)) << "particle " << i << ", substep " << k;
                    // What is left to go is no more than the gap.
                    EXPECT_FALSE(any_positive(far.left[size_t(i)] - hold.gap));
                } else {
                    far.left[size_t(i)] = hold.gap;
                }
                (is_far ? said : near)++;
            }
        }
        EXPECT_GT(said, near) << count;
        far.forget();
        EXPECT_FALSE(far.is_far(0, x[0], p));
    }
}

TEST(SolidTree, stands_where_solids_are_many) {
    std::string few = dry_scene, many;
    for (size_t k = 0; k < most_solids_in_a_loop; ++k) few += "[[solid]]\nradius = 0.02\n";
    many = few + "[[solid]]\nradius = 0.02\n";
    EXPECT_FALSE(posed_scene_at<float>(scene_of(few), 0, 0.01).tree);
    EXPECT_TRUE(posed_scene_at<float>(scene_of(many), 0, 0.01).tree);
}

// --- what is seen

TEST(Display, leads_strands_around_what_they_cross) {
    const Scene scene = scene_of(crossed_scene);
    const Strands through = crossing(scene);
    Strands p = through;
    Display(scene).apply(p, Pose(), 0);
    int inside = 0;
    for (int s = 0; s < p.count; ++s)
        for (int i = 1; i < p.particles; ++i) {
            EXPECT_GT(norm(p.at(s, i)), 0.09f - 1e-5f);
            EXPECT_LT(norm(p.at(s, i) - p.at(s, i - 1)), 1.02f * torn_lengths * crossing_edge)
                << s << " " << i;
            inside += norm(through.at(s, i)) < 0.08f;
        }
    EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace wetcurl
