// Whole simulations on small grooms: the same bits for any number of threads, nested grids, equilibria,
// contact, what is absent, what every parameter is for, divergence.
#include <algorithm>
#include <Eigen/SVD>
#include <numeric>

#include "solver/chain/scene_checks.h"
#include "solver/run/simulation.h"
#include "tests/base/threads.h"
#include "tests/solver/one_strand.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;
using std::string;

TEST(Simulation, gives_the_same_bits_for_one_and_three_threads) {
    // Three blocks of double precision and more, so that threads share them.
    const Scene scene = scene_of(wet_scene, {"groom.grid=[6, 6]"});
    const auto [one, three] = with_one_and_three_threads([&] { return after(scene, 6, "double"); });
    EXPECT_TRUE(same_bits(one.positions, three.positions));
    EXPECT_TRUE(same_bits(one.displayed, three.displayed));
    EXPECT_GT(farthest(one.positions, scene.groom.rest), 1e-3);
    EXPECT_GT(farthest(one.positions, one.displayed), 1e-3);
    // What goes over all strands at once, its own way each.
    for (const string set : {"cohesion.spacing=0.02", "cohesion.relaxation=2.5", "cohesion.strength=20"}) {
        const Scene other = scene_of(wet_scene, {"groom.grid=[8, 8]", set});
        const auto [alone, shared] = with_one_and_three_threads([&] { return after(other, 6); });
        EXPECT_TRUE(same_bits(alone.positions, shared.positions)) << set;
        EXPECT_TRUE(same_bits(alone.displayed, shared.displayed)) << set;
        EXPECT_GT(farthest(alone.positions, alone.displayed), 1e-3) << set;
    }
}

TEST(Simulation, of_low_resolution_is_every_second_strand_of_the_high_one) {
    const string text = without(wet_scene, "[cohesion]");
    const Scene fine = scene_of(text, {"groom.grid=[6, 6]"}),
                coarse = scene_of(text, {"groom.grid=[6, 6]"}, 2);
    const RunFrame a = after(fine, 8), b = after(coarse, 8);
    EXPECT_GT(farthest(a.positions, fine.groom.rest), 1e-3);
    int equal = 0;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            for (int i = 0; i < coarse.groom.rest.particles; ++i)
                equal += same_bits(a.positions.at(fine.groom.grid.at(2 * column, 2 * row), i),
                                   b.positions.at(coarse.groom.grid.at(column, row), i));
    EXPECT_EQ(equal, 9 * coarse.groom.rest.particles);
}

TEST(Simulation, without_gravity_the_drawn_shape_stays) {
    const Scene scene = scene_of(dry_scene, {"integrator.gravity=[0, 0, 0]"});
    // Positions are single: half an ulp of 0.1 m.
    EXPECT_LT(farthest(after(scene, 24, "double").positions, scene.groom.rest), 1e-8);
    EXPECT_GT(farthest(after(scene_of(dry_scene), 24, "double").positions, scene.groom.rest), 1e-3);
}

TEST(Simulation, free_of_sag_the_drawn_shape_stays_under_gravity) {
    const Scene scene = scene_of(dry_scene, {"groom.rest='sag_free'"});
    EXPECT_LT(farthest(after(scene, 24, "double").positions, scene.groom.rest), 1e-4 * 0.15);
}

TEST(Simulation, in_single_precision_stays_near_the_double_one) {
    const Scene scene = scene_of(dry_scene);
    const double apart = farthest(after(scene, 24).positions, after(scene, 24, "double").positions);
    EXPECT_GT(apart, 0);
    EXPECT_LT(apart, 1e-3 * 0.15);
}

TEST(Simulation, roots_follow_the_head) {
    const Scene scene = scene_of(wet_scene);
    const RunFrame frame = after(scene, 5);
    const Pose head = scene.motion.at(5.0 / 24);
    EXPECT_GT(norm(head(Vec3d{0.1, 0, 0}) - Vec3d{0.1, 0, 0}), 0.01);
    for (int s = 0; s < scene.groom.rest.count; ++s)
        for (int i = 0; i < 2; ++i) {
            const Vec3d wanted = head(cast<double>(scene.groom.rest.at(s, i)));
            EXPECT_LT(norm(cast<double>(frame.positions.at(s, i)) - wanted), 1e-6);
            const Strands& shown = i == 0 ? frame.displayed : frame.positions;
            EXPECT_LT(norm(cast<double>(shown.at(s, i)) - wanted), 1e-6);
        }
}

TEST(Simulation, settling_leaves_hair_where_gravity_draws_it) {
    const Scene scene = scene_of(dry_scene, {"integrator.settle=4"});
    const auto simulation = make_simulation(scene, "double");
    RunFrame first, later;
    simulation->snapshot(first);
    for (int f = 0; f < 12; ++f) simulation->advance();
    simulation->snapshot(later);
    const double drop = farthest(first.positions, scene.groom.rest);
    EXPECT_GT(drop, 1e-3);
    EXPECT_LT(farthest(first.positions, later.positions), 0.2 * drop);
}

// --- contact

double deepest(const Scene& scene, const Strands& p, double time) {
    double worst = 0;
    for (const auto& solid : scene.solids) {
        const Pose pose = solid.at(time, scene.motion.at(time));
        for (int s = 0; s < p.count; ++s)
            for (int i = 2; i < p.particles; ++i) {
                const double phi = distance(solid.shape, pose.inverse(cast<double>(p.at(s, i)))).phi;
                const double drawn = distance(solid.shape, cast<double>(scene.groom.rest.at(s, i))).phi;
                worst = std::max(worst, (solid.attached ? std::min(0.0, drawn) : 0.0) - phi);
            }
    }
    return worst;
}

TEST(Simulation, lets_no_particle_lie_deeper_than_allowed) {
    const char* const solids[] = {
        "[[solid]]\nradius = 0.097\nattached = \"head\"\n",
        "[[solid]]\nradius = 0.04\n[[solid.motion.keyframe]]\ntime = 0\ntranslation = [0.3, 0, "
        "-0.1]\n[[solid.motion.keyframe]]\ntime = 0.4\ntranslation = [-0.1, 0, -0.1]\n",
        "[[solid]]\nshape = \"plane\"\n[solid.motion]\nshift = [0, 0.05, 0]\nperiod = 0.5\n",
        "[[solid]]\nshape = \"capsule\"\nradius = 0.03\n[[solid.motion.keyframe]]\ntranslation = [0, 0, "
        "-0.1]\n",
        "[[solid]]\nshape = \"box\"\nhalf = [0.02, 0.05, 0.02]\n[[solid.motion.keyframe]]\ntranslation = "
        "[0.05, 0, -0.12]\n"};
    for (const char* solid : solids) {
        SCOPED_TRACE(solid);
        const Scene scene = scene_of(dry_scene + "[motion]\nangle = 30\nperiod = 0.6\n" + solid);
        Scene free = scene_of(dry_scene + "[motion]\nangle = 30\nperiod = 0.6\n");
        const auto simulation = make_simulation(scene, "float"), without = make_simulation(free, "float");
        double worst = 0, unhindered = 0;
        RunFrame frame;
        for (int f = 1; f <= 12; ++f) {
            simulation->advance();
            simulation->snapshot(frame);
            worst = std::max(worst, deepest(scene, frame.positions, f / 24.0));
            without->advance();
            without->snapshot(frame);
            unhindered = std::max(unhindered, deepest(scene, frame.positions, f / 24.0));
        }
        EXPECT_GT(unhindered, 1e-3);
        EXPECT_LE(worst, 1e-5);
    }
}

TEST(Simulation, shows_no_hair_inside_solids) {
    const Scene scene = scene_of(wet_scene, {"cohesion.radius=0.05"});
    const auto simulation = make_simulation(scene, "float");
    RunFrame frame;
    for (int f = 1; f <= 8; ++f) {
        simulation->advance();
        simulation->snapshot(frame);
        EXPECT_LE(deepest(scene, frame.displayed, f / 24.0), 1e-5) << f;
    }
}

// --- wet hair

TEST(Simulation, frames_that_are_not_shown_change_none_that_are) {
    const Scene scene = scene_of(wet_scene);
    const auto simulation = make_simulation(scene, "float");
    RunFrame start, frame;
    simulation->snapshot(start);
    for (int f = 1; f < 4; ++f) simulation->advance(false);
    simulation->snapshot(frame);
    EXPECT_TRUE(same_bits(frame.displayed, start.displayed));
    simulation->advance();
    simulation->snapshot(frame);
    const RunFrame all = after(scene, 4);
    EXPECT_TRUE(same_bits(frame.positions, all.positions));
    EXPECT_TRUE(same_bits(frame.displayed, all.displayed));
    EXPECT_FALSE(same_bits(frame.displayed, start.displayed));
}

// Distance of the tip of a straight strand from the plane that it lay on, once that has sunk by 9 mm.
double tip_distance(const string& strength) {
    Scene scene = scene_of(
        "fps = 24\n[groom]\ngrid = [1, 1]\nparticles = 24\n[integrator]\ngravity = [0, 0, "
        "0]\n[stretch]\n[bend]\n[wetness]\n"
        "[adhesion]\nhold = 0\n[stiffness]\nglobal = 20\n[[solid]]\nshape = "
        "\"plane\"\n[[solid.motion.keyframe]]\ntime = 0.1\n"
        "[[solid.motion.keyframe]]\ntime = 1.1\ntranslation = [0, -0.009, 0]\n",
        {"adhesion.strength=" + strength});
    for (int i = 0; i < 24; ++i) scene.groom.rest.at(0, i) = {0.0065f * float(i), 0, 0};
    return double(after(scene, 36, "double").positions.at(0, 23).y) + 0.009;
}

TEST(Simulation, adhesion_draws_wet_hair_after_a_surface_that_leaves) {
    EXPECT_NEAR(tip_distance("0"), 0.009, 1e-6);
    EXPECT_LT(tip_distance("60"), 0.007);
}

// One clean helix in the groom's place.
Scene one_helix(const string& wet) {
    Scene scene = scene_of(
        "fps = 24\n[groom]\ngrid = [1, 1]\nparticles = 50\n[integrator]\ngravity = [0, 0, "
        "0]\n[stretch]\n[bend]\n[core]\n[stiffness]\nglobal = 10\n" +
        wet);
    const Points p = helix_points(50, 0.25, 0.006, 0.025);
    for (int i = 0; i < 50; ++i) scene.groom.rest.at(0, i) = cast<float>(p[size_t(i)]);
    return scene;
}
double axial_extent(const Strands& p) {
    Eigen::MatrixXd bends(p.particles - 3, 3);
    for (int i = 1; i + 2 < p.particles; ++i) {
        const Vec3d d =
            cast<double>(p.at(0, i + 2)) - 2.0 * cast<double>(p.at(0, i + 1)) + cast<double>(p.at(0, i));
        bends.row(i - 1) << d.x, d.y, d.z;
    }
    const Eigen::Vector3d a = Eigen::JacobiSVD<Eigen::MatrixXd>(bends, Eigen::ComputeThinV).matrixV().col(2);
    const Vec3d d = cast<double>(p.at(0, p.particles - 1)) - cast<double>(p.at(0, 1));
    return std::abs(a[0] * d.x + a[1] * d.y + a[2] * d.z);
}

TEST(Simulation, a_wet_curl_without_gravity_contracts_to_its_extent) {
    const Scene dry = one_helix("");
    const double dry_extent = axial_extent(after(dry, 72, "double").positions);
    EXPECT_NEAR(dry_extent, axial_extent(dry.groom.rest), 1e-6);
    const double wet =
        axial_extent(after(one_helix("[wetness]\n[curl]\ncontraction = 0.75\n"), 72, "double").positions);
    std::printf("Fig 28: wet / dry axial extent %.4f, asked for 0.75\n", wet / dry_extent);
    EXPECT_NEAR(wet / dry_extent, 0.75, 0.02);
}

TEST(Simulation, wet_weight_makes_hair_droop) {
    const Scene dry = scene_of(dry_scene, {"integrator.settle=2"}),
                wet = scene_of(dry_scene + "[wetness]\nabsorbed = 1\n", {"integrator.settle=2"});
    auto mean_height = [](const Scene& scene) {
        double sum = 0;
        const Strands p = after(scene, 0, "double").positions;
        for (int s = 0; s < p.count; ++s) sum += p.at(s, p.particles - 1).y;
        return sum / p.count;
    };
    EXPECT_LT(mean_height(wet), mean_height(dry) - 1e-4);
}

// A network in Eq 11's place.
struct GivenAdhesion : AdhesionPredictor {
    double answer;
    size_t asked = 0;
    explicit GivenAdhesion(double answer) : answer(answer) {}
    void evaluate(const float* inputs, size_t count, float* outputs) override {
        asked += count;
        for (size_t k = 0; k < count; ++k) {
            EXPECT_TRUE(std::isfinite(inputs[12 * k]));
            outputs[k] = float(answer);
        }
    }
};

TEST(Simulation, takes_the_adhesion_that_a_model_gives) {
    const Scene scene = scene_of(wet_scene);
    auto run = [&](double answer) {
        GivenAdhesion model(answer);
        const auto simulation = make_simulation(scene, "float");
        simulation->use_adhesion_predictor(&model);
        for (int f = 0; f < 4; ++f) simulation->advance();
        EXPECT_GT(model.asked, 100u);
        RunFrame frame;
        simulation->snapshot(frame);
        return frame.positions;
    };
    EXPECT_GT(farthest(run(0), run(-1)), 1e-4);
}

TEST(Simulation, records_what_an_adhesion_network_learns_from) {
    const Scene scene = scene_of(wet_scene);
    const auto simulation = make_simulation(scene, "float");
    std::vector<AdhesionRecord> records;
    simulation->record_adhesion(&records);
    for (int f = 0; f < 8; ++f) simulation->advance();
    int in_contact = 0, pulled = 0;
    for (const auto& r : records) {
        for (float in : r.inputs) EXPECT_TRUE(std::isfinite(in));
        EXPECT_EQ(r.contact, r.inputs[4] == 1);
        float value, slope;
        Adhesion::shape(r.inputs[6], value, slope);
        EXPECT_NEAR(r.target, r.contact ? -value : 0, 1e-5);
        in_contact += r.contact;
        pulled += r.target < -0.1;
    }
    EXPECT_GT(in_contact, 50);
    EXPECT_GT(pulled, 5);
    EXPECT_LT(size_t(in_contact), records.size());
    // Recording leaves the run as it is.
    RunFrame recorded;
    simulation->snapshot(recorded);
    EXPECT_LT(farthest(recorded.positions, after(scene, 8).positions), 1e-6);
}

// --- what is absent

bool any_names(const std::vector<string>& names, const string& part) {
    return std::any_of(names.begin(), names.end(),
                       [&](const string& n) { return n.find(part) != string::npos; });
}
std::vector<string> buffer_names(const Scene& scene) {
    std::vector<string> names;
    for (const auto& b : make_simulation(scene, "float")->buffers()) {
        names.push_back(b.name);
        EXPECT_GT(b.bytes, 0u) << b.name;
    }
    return names;
}

TEST(Simulation, of_a_dry_scene_has_nothing_of_what_it_does_not_name) {
    const Scene dry = scene_of(dry_scene), wet = scene_of(wet_scene);
    const Presence has = presence_of(dry), wet_has = presence_of(wet);
    const auto buffers = buffer_names(dry), wet_buffers = buffer_names(wet);
    for (const char* name : {"wetness", "curl", "cohesion", "adhesion", "contact", "stiffness"}) {
        EXPECT_FALSE(any_names(has.present, name)) << name;
        EXPECT_TRUE(any_names(has.absent, name)) << name;
        EXPECT_TRUE(any_names(wet_has.present, name)) << name;
    }
    for (const char* name : {"saturation", "cohesion", "displayed", "adhesion", "depth", "level set", "curl"})
        EXPECT_FALSE(any_names(buffers, name)) << name;
    for (const char* name : {"saturation", "cohesion", "displayed", "adhesion"})
        EXPECT_TRUE(any_names(wet_buffers, name)) << name;
    const auto simulation = make_simulation(dry, "float");
    EXPECT_EQ(simulation->stages, std::vector<string>{"chain"});
    EXPECT_EQ(after(dry, 1).displayed.count, 0);
    EXPECT_TRUE(after(dry, 1).contact.empty());
}

TEST(Simulation, without_bend_and_core_has_no_frames_targets_or_cores) {
    string text = dry_scene;
    text.erase(text.find("[bend]"));
    const auto buffers = buffer_names(scene_of(text));
    for (const char* name : {"bend", "core"}) EXPECT_FALSE(any_names(buffers, name)) << name;
    EXPECT_TRUE(any_names(buffer_names(scene_of(dry_scene)), "bend"));
}

TEST(Simulation, memory_is_220_bytes_a_wet_particle_and_100_a_dry_one_at_most) {
    string text = wet_scene;
    text.erase(text.find("[adhesion]"), string("[adhesion]\n").size());
    const Scene scene = scene_of(text, {"groom.grid=[32, 32]", "groom.particles=50", "groom.length=0.25",
                                        "cohesion.radius=0.0073", "integrator.settle=1"});
    auto bytes_each = [&](const Simulation& simulation) {
        size_t bytes = 0;
        for (const auto& b : simulation.buffers())
            if (b.name != "scratch of the threads") bytes += b.bytes;
        return double(bytes) / double(scene.groom.rest.points.size());
    };
    Scene without_water = scene;
    make_dry(without_water);
    const auto wet = make_simulation(scene, "float"), dry = make_simulation(without_water, "float");
    wet->advance();
    std::printf("%.0f bytes a wet particle, %.0f a dry one, %.1f neighbours\n", bytes_each(*wet),
                bytes_each(*dry), wet->neighbours_mean());
    EXPECT_NEAR(wet->neighbours_mean(), 35, 5);
    // A list serves as many particles as a vector holds quads: with SSE, one each, there are 233 bytes.
    EXPECT_LE(bytes_each(*wet), Pack<float>::lanes >= 8 ? 220 : 240);
    EXPECT_LE(bytes_each(*dry), 100);
}

TEST(Simulation, a_term_at_zero_stiffness_is_there_all_the_same) {
    const Scene zero =
        scene_of(dry_scene, {"bend.stiffness=0", "core.stiffness=0", "bend.damping=0", "core.damping=0"});
    string text = dry_scene;
    text.erase(text.find("[bend]"));
    const Scene absent = scene_of(text);
    EXPECT_LT(farthest(after(zero, 6, "double").positions, after(absent, 6, "double").positions), 1e-6);
    EXPECT_TRUE(any_names(presence_of(zero).present, "bend"));
}

// --- divergence, limiter, energy

TEST(Simulation, an_explicit_run_of_stiff_hair_is_seen_to_diverge_and_a_term_is_named) {
    const std::vector<string> stiff{"integrator.kind='explicit'", "integrator.limiter=0",
                                    "stretch.stiffness=1000"};
    const Scene scene = scene_of(dry_scene, stiff);
    const auto simulation = make_simulation(scene, "float");
    int frames = 0;
    while (!simulation->divergence() && frames < 10) simulation->advance(), ++frames;
    const auto found = simulation->divergence();
    ASSERT_TRUE(found);
    EXPECT_GE(frames, 1);
    const auto& kinds = simulation->energy_kinds;
    EXPECT_NE(std::find(kinds.begin(), kinds.end(), found->largest_term), kinds.end());
    EXPECT_NE(found->largest_term, "gravity");
    EXPECT_TRUE(found->strand >= 0 && found->strand < 16);

    const Scene stiff_only = scene_of(dry_scene, {"stretch.stiffness=1000"});
    const auto implicit = make_simulation(stiff_only, "float");
    for (int f = 0; f < 10; ++f) implicit->advance();
    EXPECT_FALSE(implicit->divergence());
}

TEST(Simulation,
     springs_beside_a_light_particle_are_as_stiff_as_it_is_light_and_double_precision_takes_them) {
    const Scene even = scene_of(dry_scene, {"groom.grid=[2, 2]", "stretch.stiffness=20"});
    Scene uneven = even;
    Vec3f* p = uneven.groom.rest.points.data();
    for (int side : {-1, 1}) p[10 + side] = p[10] + 0.01f * (p[10 + side] - p[10]);
    EXPECT_NEAR(stiffness_number(uneven) / stiffness_number(even), 100, 15);
    EXPECT_EQ(trusted_precision(even, "float"), "float");
    EXPECT_EQ(trusted_precision(uneven, "float"), "double");
}

TEST(Simulation, an_explicit_run_of_soft_hair_agrees_with_the_implicit_one_as_both_are_refined) {
    // Damped, so that the fastest modes end within the run: a phase has no order.
    const std::vector<string> soft{"stretch.stiffness=0.05", "bend.stiffness=0.0005", "core.stiffness=0.0005",
                                   "integrator.limiter=0",   "stretch.damping=1e-4",  "stiffness.dry=20"};
    auto with = [&](const char* kind, const char* substeps) {
        auto set = soft;
        set.push_back(kind);
        set.push_back(substeps);
        return after(scene_of(dry_scene, set), 3, "double").positions;
    };
    const Strands fine = with("integrator.kind='implicit'", "integrator.substeps=4000");
    const double a = farthest(with("integrator.kind='explicit'", "integrator.substeps=500"), fine);
    const double b = farthest(with("integrator.kind='explicit'", "integrator.substeps=2000"), fine);
    EXPECT_GT(a, 1e-7);
    EXPECT_NEAR(a / b, 4, 1);  // symplectic Euler is of order one
}

TEST(Simulation, a_backward_euler_run_taken_over_from_bdf2_stays_one) {
    const Scene bdf2 = scene_of(dry_scene), euler = scene_of(dry_scene, {"integrator.kind='backward_euler'"});
    const auto before = make_simulation(bdf2, "double"), after = make_simulation(euler, "double");
    before->advance();
    const SimulationState state = before->state();
    ASSERT_FALSE(state.first);
    after->restore(state);
    EXPECT_TRUE(after->state().first);
}

TEST(Simulation, counts_the_edges_that_its_limiter_shortens) {
    const Scene scene = scene_of(dry_scene, {"stretch.stiffness=0.001", "bend.stiffness=0.001",
                                             "core.stiffness=0.001", "integrator.limiter=0.05"});
    const auto limited = make_simulation(scene, "float");
    for (int f = 0; f < 6; ++f) limited->advance();
    EXPECT_GT(limited->limited_edges(), 10);
    RunFrame frame;
    limited->snapshot(frame);
    for (int s = 0; s < scene.groom.rest.count; ++s)
        for (int i = 1; i + 1 < 24; ++i)
            // Its spring gives way to the load by a share of 1e-4 or so.
            EXPECT_LE(norm(frame.positions.at(s, i + 1) - frame.positions.at(s, i)),
                      1.051f * norm(scene.groom.rest.at(s, i + 1) - scene.groom.rest.at(s, i)));
    const Scene free_scene =
        scene_of(dry_scene, {"stretch.stiffness=0.001", "bend.stiffness=0.001", "core.stiffness=0.001"});
    const auto free = make_simulation(free_scene, "float");
    free->advance();
    EXPECT_EQ(free->limited_edges(), 0);
}

TEST(Simulation, energy_of_undriven_hair_never_grows) {
    const Scene scene = scene_of(dry_scene, {"stretch.damping=0", "bend.damping=0", "core.damping=0"});
    const auto simulation = make_simulation(scene, "double");
    double start = 0, most = -1e9, kinetic = 0;
    RunFrame frame;
    for (int f = 0; f <= 48; ++f) {
        simulation->snapshot(frame);
        double sum = 0;
        for (float e : frame.energy) sum += e;
        if (f == 0) start = sum;
        most = std::max(most, sum);
        kinetic = std::max(kinetic, double(frame.energy[0]));
        simulation->advance();
    }
    ASSERT_EQ(frame.energy.size(), simulation->energy_kinds.size());
    EXPECT_GT(kinetic, 1e-8);
    // Energies are stored in single precision.
    EXPECT_LE(most, start + 1e-6 * std::abs(start));
}

// The largest rise of the energy, of how far it falls in all.
double largest_rise(const std::string& terms) {
    const auto course =
        energy_course(scene_of("fps = 24\n[groom]\ngrid = [4, 4]\nparticles = 50\n" + terms), 48);
    EXPECT_GT(course.fall, 0);
    return course.rise / course.fall;
}

// Hair that stands up all around falls onto a head: the head may take energy, never give it.
TEST(Simulation, a_still_head_gives_no_energy) {
    for (const char* friction : {"0", "0.3", "2"})
        EXPECT_LT(largest_rise("[stretch]\n[bend]\n[core]\n[stiffness]\n[wetness]\n[[solid]]\nradius = "
                               "0.095\nattached = 'head'\nfriction = " +
                               std::string(friction)),
                  5e-3)
            << friction;
}

// Sec. VI.I at ten substeps: hair falls and whips with nothing to hold it.
TEST(Simulation, hair_that_whips_freely_gains_no_energy) {
    const std::string dry = "[stretch]\n[bend]\n[core]\n";
    EXPECT_LT(largest_rise(dry), 1e-9);
    EXPECT_LT(largest_rise(dry + "[stiffness]\n[wetness]\n"), 1e-9);
}

// Nothing keeps its edges from folding up and whipping about.
TEST(Simulation, a_chain_without_bends_falls_without_gaining_energy) {
    EXPECT_LT(largest_rise("[stretch]\n"), 1e-9);
}

}  // namespace
}  // namespace wetcurl
