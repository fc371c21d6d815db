// The battery of stability: ours stands it, each check is seen to fail on a broken way of stepping, and the
// work that it counts is that of analytic cases.
#include <omp.h>

#include <algorithm>

#include "solver/stability/trial.h"
#include "tests/solver/one_strand.h"

namespace wetcurl {
namespace {

using namespace testing;
using Cases = std::vector<StabilityCase>;

StabilityMethod ours(const std::string& precision = "double") {
    return {"ours", "implicit " + precision, precision, {}, 2, {}, {}};
}

// Groups of cases side by side, as the program runs them: one strand is too little for two threads.
Cases cases_of(const StabilityMethod& method, const std::string& id) {
    StabilityOptions options;
    options.quick = true;
    options.only = {id};
    Cases out;
    const auto jobs = stability_jobs(method, options);
    std::vector<Cases> results(jobs.size());
#pragma omp parallel for schedule(dynamic)
    for (size_t k = 0; k < jobs.size(); ++k) results[k] = jobs[k].run();
    for (const auto& group : results)
        for (const auto& c : group) {
            EXPECT_EQ(c.id, id);
            out.push_back(c);
        }
    EXPECT_FALSE(out.empty());
    return out;
}
double figure(const Figures& all, const std::string& name) {
    for (const auto& [key, value] : all)
        if (key == name) return value;
    return NAN;
}
const StabilityMethod& method_named(const std::string& name) {
    const auto& methods = stability_methods();
    return *std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.name == name; });
}
// The paper's scheme.
const StabilityMethod& printed() { return method_named("printed"); }

// Whether a case whose name begins with `what` fails.
bool sees(const StabilityMethod& broken, const std::string& id, const std::string& what = "") {
    const Cases all = cases_of(broken, id);
    return std::any_of(all.begin(), all.end(),
                       [&](const StabilityCase& c) { return !c.passed && c.what.find(what) == 0; });
}

// Ours, and then `change(state, dt)` after each frame.
template <class Change>
StabilityMethod ours_and(Change change) {
    StabilityMethod m = ours();
    m.advance = [change](Simulation& simulation, const Scene& scene) {
        simulation.advance();
        SimulationState state = simulation.state();
        change(state, 1 / (scene.fps * scene.integrator.substeps));
        simulation.restore(state);
    };
    return m;
}

// v += dt f / m, x += dt v of before.
StabilityMethod forward_euler() {
    StabilityMethod m = ours();
    m.advance = [](Simulation& simulation, const Scene& scene) {
        SimulationState s = simulation.state();
        const int n = scene.groom.rest.particles;
        const double dt = 1 / (scene.fps * scene.integrator.substeps);
        for (int strand = 0; strand < scene.groom.rest.count; ++strand) {
            const StrandRest rest = rest_state_of(scene, strand);
            OneStrand one(rest.start, scene.linear_density);
            one.target = rest.target, one.rest_core = rest.rest_core;
            const size_t k = size_t(strand) * size_t(n);
            for (int i = 0; i < n; ++i)
                one.x[size_t(i)] = s.x[k + size_t(i)], one.v[size_t(i)] = s.v[k + size_t(i)];
            one.frame.assign(s.frame.begin() + long(k), s.frame.begin() + long(k) + n - 1);
            const Points force = forces_by(
                [&](const auto& view, const auto& system) {
                    for_each_present(scene.chain, [&](const auto& term) { assemble(term, view, system); });
                },
                one.view(), dt);
            for (size_t i = 2; i < size_t(n); ++i) {
                s.x[k + i] += dt * s.v[k + i];
                s.v[k + i] += dt * (scene.integrator.gravity + (1 / one.mass[i]) * force[i]);
            }
        }
        carry_frames(s, n);
        s.time += dt;
        simulation.restore(s);
    };
    return m;
}

// The terms' own assembly with a change of force or matrix behind it.
template <class Change>
StabilityMethod ours_assembled_with(Change change) {
    StabilityMethod m = ours();
    m.assemble = [change](const ChainTerms& terms, const ChainView<double>& c, const ChainSystem<double>& a) {
        for_each_present(terms, [&](const auto& term) { assemble(term, c, a); });
        change(terms, c, a);
    };
    return m;
}

// --- ours

TEST(Battery, ours_stands_it_in_single_and_double) {
    for (const char* precision : {"double", "float"})
        for (const char* id : {"S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8", "S9"})
            for (const auto& c : cases_of(ours(precision), id))
                EXPECT_TRUE(c.passed) << precision << " " << c.id << " " << c.what;
}
TEST(Battery, ours_stands_it_with_fibres_in_the_place_of_springs) {
    for (const char* precision : {"double", "float"}) {
        StabilityMethod fibres = ours(precision);
        fibres.fibre = 70e-6;
        for (const char* id : {"S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8", "S9", "S10"})
            for (const auto& c : cases_of(fibres, id))
                EXPECT_TRUE(c.passed) << precision << " " << c.id << " " << c.what;
    }
}
// Touching and, wet, cohering in the solve.
TEST(Battery, ours_stands_it_with_fibres_that_touch) {
    for (const StabilityMethod& touching : stability_methods()) {
        if (touching.name != "ours touching") continue;
        for (const char* id : {"S1", "S2", "S5", "S7", "S9"})
            for (const auto& c : cases_of(touching, id)) {
                EXPECT_TRUE(c.passed) << touching.precision << " " << c.id << " " << c.what;
                if (c.id == "S9") {
                    EXPECT_GT(figure(c.measured, "neighbours"), 1) << c.what;
                }
            }
    }
}

TEST(Battery, the_printed_scheme_fails_where_the_paper_shakes) {
    for (const char* id : {"S1", "S3", "S4"}) EXPECT_TRUE(sees(printed(), id)) << id;
}

// Each group of cases of the methods on Iben's chain runs, and that they fail is of their steps, not of their
// scenes.
TEST(Battery, runs_wet_forces_on_iben_s_chain) {
    for (const char* name : {"lin on iben", "kim on iben"})
        for (const char* id : {"S1", "S2", "S5", "S7", "S9"}) {
            const Cases all = cases_of(method_named(name), id);
            EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const StabilityCase& c) { return !c.passed; }))
                << name << " " << id;
        }
}

// --- broken ones

TEST(Battery, sees_a_state_that_is_not_finite) {
    const auto broken = ours_and([](SimulationState& s, double) { s.v.back().x = NAN; });
    for (const char* id : {"S1", "S2", "S4", "S5"})
        for (const auto& c : cases_of(broken, id))
            EXPECT_FALSE(c.passed && c.what != "two particles") << id << c.what;
}

TEST(Battery, sees_forward_euler) {
    EXPECT_TRUE(sees(forward_euler(), "S1"));
    EXPECT_TRUE(sees(forward_euler(), "S2", "small sway"));
    EXPECT_TRUE(sees(forward_euler(), "S4"));
}

// Less than a thousandth a frame: nothing that a picture shows.
TEST(Battery, sees_energy_that_comes_from_nowhere) {
    const auto broken = ours_and([](SimulationState& s, double) {
        for (auto& v : s.v) v = 1.02 * v;
        for (auto& v : s.v_before) v = 1.02 * v;
    });
    for (const char* what : {"small sway", "large sway", "fall", "shaken root", "wet lock released",
                             "wet lock in a large sway", "wet lock, shaken root", "wet, swept by a ball"})
        EXPECT_TRUE(sees(broken, "S2", what)) << what;
    // Ten substeps a frame.
    const auto in_each_substep = ours_and([](SimulationState& s, double) {
        for (auto& v : s.v) v = 1.2 * v;
        for (auto& v : s.v_before) v = 1.2 * v;
    });
    StabilityMethod of_fibres = in_each_substep;
    of_fibres.fibre = 70e-6;
    EXPECT_TRUE(sees(of_fibres, "S10", "fibres that fall"));
    for (const char* what : {"noise at rest", "noise beside wet neighbours"})
        EXPECT_TRUE(sees(broken, "S1", what)) << what;
}

TEST(Battery, sees_forces_and_matrices_that_are_none) {
    const auto wrong_twist = ours_assembled_with([](const ChainTerms& terms, const ChainView<double>& c,
                                                    const ChainSystem<double>& a) {
        const Twist& twist = *std::get<std::optional<Twist>>(terms);
        const Points f =
            forces_by([&](const auto& view, const auto& system) { assemble(twist, view, system); }, c, a.h);
        for (int i = 0; i < c.n; ++i) a.force(i) -= 2.0 * f[size_t(i)];
    });
    EXPECT_TRUE(sees(wrong_twist, "S3", "force differenced"));
    const auto one_sided =
        ours_assembled_with([](const ChainTerms&, const ChainView<double>& c, const ChainSystem<double>& a) {
            a.force(5) += 1e-3 * (c.x[9] - c.x[8]);
        });
    EXPECT_TRUE(sees(one_sided, "S3", "force differenced"));
    const auto negative =
        ours_assembled_with([](const ChainTerms&, const ChainView<double>& c, const ChainSystem<double>& a) {
            if (a.with_matrix()) a.diagonal(c.n - 1) += identity_times(-1.0);
        });
    EXPECT_TRUE(sees(negative, "S3", "assembled matrix"));
    const auto halved =
        ours_assembled_with([](const ChainTerms&, const ChainView<double>& c, const ChainSystem<double>& a) {
            for (int i = 0; a.with_matrix() && i + 1 < c.n; ++i) {
                const Sym3<double> d = a.edge(i);
                a.edge(i) += Sym3<double>{-0.5 * d.xx, -0.5 * d.xy, -0.5 * d.xz,
                                          -0.5 * d.yy, -0.5 * d.yz, -0.5 * d.zz};
            }
        });
    EXPECT_TRUE(sees(halved, "S3", "matrix above"));
}

TEST(Battery, sees_a_shape_that_does_not_hang_and_hair_that_does_not_settle) {
    const auto lifted = ours_and([](SimulationState& s, double) {
        for (auto& v : s.v) v.x += 0.05;
    });
    EXPECT_TRUE(sees(lifted, "S4"));
    const auto kicked = ours_and([](SimulationState& s, double) {
        static int sign = 1;
        sign = -sign;
        for (auto& v : s.v) v.x += 0.2 * sign;
    });
    for (const char* what : {"10 g", "wet lock at 10 g", "coincident strands", "wet, tip inside a solid"})
        EXPECT_TRUE(sees(kicked, "S5", what)) << what;
    EXPECT_TRUE(sees(kicked, "S9"));
}

TEST(Battery, sees_an_error_of_first_order) {
    const auto broken = ours_and([](SimulationState& s, double dt) {
        for (auto& x : s.x) x.x += 0.1 * dt;
    });
    EXPECT_TRUE(sees(broken, "S6", "order in dt"));
}

TEST(Battery, finds_backward_euler_of_order_one) {
    StabilityMethod euler = ours();
    euler.settings = {"integrator.kind='backward_euler'"};
    EXPECT_TRUE(sees(euler, "S6", "order in dt"));  // it is not of order 2
    euler.order = 1;
    EXPECT_FALSE(sees(euler, "S6", "order in dt"));
}

TEST(Battery, sees_fibres_that_depend_on_the_number_of_particles) {
    StabilityMethod slower = ours_and([](SimulationState& s, double) {
        const double kept = 1 - 2e-4 * double(s.v.size());
        for (auto& v : s.v) v = kept * v;
        for (auto& v : s.v_before) v = kept * v;
    });
    slower.fibre = 70e-6;
    EXPECT_TRUE(sees(slower, "S6", "order in N of type3b, dry"));
}

TEST(Battery, sees_what_depends_on_place_direction_order_and_unit) {
    const auto placed = ours_and([](SimulationState& s, double) {
        for (auto& v : s.v) v += 1e-6 * s.x.front();
    });
    EXPECT_TRUE(sees(placed, "S7", "translation"));
    EXPECT_TRUE(sees(placed, "S7", "translation by 1 km, wet lock"));
    const auto directed = ours_and([](SimulationState& s, double) {
        for (auto& v : s.v) v.x += 1e-2;
    });
    EXPECT_TRUE(sees(directed, "S7", "rotation"));
    EXPECT_TRUE(sees(directed, "S7", "unit"));
    const auto first = ours_and([](SimulationState& s, double) {
        for (size_t i = 2; i < 50; ++i) s.v[i].x += 1e-6;
    });
    EXPECT_TRUE(sees(first, "S7", "strand permutation"));
    EXPECT_TRUE(sees(first, "S7", "strand permutation, wet lock"));
}

TEST(Battery, reports_the_work_of_the_limiter_and_sees_it_give_energy) {
    for (const auto& c : cases_of(ours(), "S8")) {
        EXPECT_TRUE(c.passed);
        EXPECT_GT(figure(c.measured, "limited_edges"), 0);
        EXPECT_LT(figure(c.measured, "sum_over_weight"), 0);
    }
    // The one that moves particles after the step.
    for (const auto& c : cases_of(printed(), "S8")) {
        EXPECT_FALSE(c.passed);
        // It is all that a still root's hair can gain.
        EXPECT_GT(figure(c.measured, "sum_over_weight"), 0);
    }
}

// --- compared methods

TEST(Sweep, takes_the_strongest_effect_of_those_that_hold_and_else_the_calmest) {
    auto point = [](double effect, double jitter, double energy_ratio) {
        SweepPoint p;
        p.effect = effect, p.jitter = jitter, p.energy_ratio = energy_ratio;
        return p;
    };
    const double still = 0.1 * jitter_bound, restless = 10 * jitter_bound;
    const std::vector<SweepPoint> some{point(0.1, still, 0), point(0.3, still, 0), point(0.5, restless, 0),
                                       point(0.7, still, 10 * energy_bound)};
    EXPECT_EQ(best_of(some).effect, 0.3);
    const std::vector<SweepPoint> none{point(0.5, 3 * restless, 0), point(0.1, restless, 0)};
    EXPECT_EQ(best_of(none).effect, 0.1);
    const std::vector<SweepPoint> idle{point(NAN, still, 0), point(NAN, 0.1 * still, 0)};
    EXPECT_EQ(best_of(idle).jitter, 0.1 * still);
    EXPECT_FALSE(point(1, NAN, 0).holds());
}

// Its potential's loss, and so its work is none that comes from outside.
TEST(Work, of_a_compared_method_s_forces_is_what_their_potential_loses) {
    const std::vector<std::pair<std::string, std::string>> defaults{{"lin", "3000"},
                                                                    {"boundary_particles", "10"}};
    for (const auto& [name, strength] : defaults) {
        StabilityMethod method = method_named(name);
        method.settings.push_back("baseline.strength=" + strength);
        StrandSetup setup{{straight_points(50, 0.25, {0, -1, 0}), straight_points(50, 0.25, {0, -1, 0})},
                          1e5,
                          1.0 / 960,
                          0,
                          {0, 0, 0},
                          5,
                          "[wetness]\n" + method.cohesion,
                          {}};
        for (auto& p : setup.shapes[1]) p.x += 0.008;
        if (method.on_solids)
            setup.more =
                "[wetness]\n" + method.adhesion +
                "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntranslation = [0.058, -0.2, 0]\n";
        Trial trial(method, scene_of(setup, method));
        const double before = trial.simulation().energy().back();
        trial.advance_for(0.5);
        const double lost = before - trial.simulation().energy().back();
        EXPECT_LT(before, 0);
        EXPECT_GT(lost, 1e-3 * -before) << name;
        EXPECT_NEAR(trial.simulation().work().forces, lost, 0.02 * lost) << name;
        EXPECT_LE(trial.energy_ratio(), energy_bound) << name;
    }
}

// The paper, Sec. VI.I: the largest rise of the energy over its lowest so far, over m g L, on wet hair let go
// of with nothing from outside. Kinetic and elastic energy, gravity's and, where wet forces have one, their
// potential. `factor`: of a compared method's middling strength.
double rise_of(const std::string& name, double factor, int substeps) {
    const StabilityMethod& method = method_named(name);
    std::vector<std::string> set{"integrator.substeps=" + std::to_string(substeps)};
    if (method.compared())
        for (const auto& [key, value] : method.sweep[method.sweep.size() / 2])
            set.push_back(setting("baseline." + key, factor * value));
    Trial trial(method, scene_of("[groom]\ngrid = [8, 8]\nparticles = 50\ncoverage = 0.4\n[stretch]\n[bend]\n"
                                 "[core]\n[wetness]\n" +
                                     method.cohesion,
                                 "energy", ".", set, method));
    double lowest = trial.total(), rise = 0;
    for (int f = 0; f < 24; ++f) {
        trial.advance();
        lowest = std::min(lowest, trial.total()), rise = std::max(rise, trial.total() - lowest);
    }
    EXPECT_TRUE(trial.finite) << name;
    EXPECT_GT(trial.most_kinetic, 1e-3 * trial.weight_length()) << name;
    const double share = rise / trial.weight_length();
    std::printf("%s, %d substeps, strength x %g: energy rises by %.2g m g L\n", name.c_str(), substeps,
                factor, share);
    return share;
}
TEST(Energy, of_ours_does_not_rise_in_short_steps_and_theirs_does_where_they_pull_hard) {
    EXPECT_LE(rise_of("ours", 1, 40), 1e-9);
    // Steps of ten a frame leave a little at a swing's turn, once, with wet forces or without.
    EXPECT_LE(rise_of("ours", 1, 10), 0.01);
    for (const char* name : {"lin", "kim"}) {
        EXPECT_LE(rise_of(name, 1, 10), 0.01);
        EXPECT_GT(rise_of(name, 100, 10), 0.1);
    }
}

// --- work

constexpr double lift = 0.3;
std::string lifted(const std::string& how) {
    return "[motion]\n[[motion.keyframe]]\ntime = 0.2\n[[motion.keyframe]]\ntime = 2.2\n" + how + "\n";
}

TEST(Work, of_a_lifted_root_is_weight_times_height) {
    for (const char* precision : {"double", "float"})
        for (double k_over_m : {1e4, 1e7}) {
            const StabilityMethod method = ours(precision);
            StrandSetup setup{{straight_points(50, 0.25, {0, -1, 0}), helix_points(50, 0.25, 0.006, 0.025)},
                              k_over_m,
                              1.0 / 240,
                              0,
                              {0, -9.81, 0},
                              20,
                              "",
                              {}};
            // It hangs first, then is lifted, and hangs again.
            Trial trial(method, scene_of(setup, method));
            trial.advance_for(6);
            setup.more = lifted("translation = [0, 0.3, 0]");
            SimulationState still = trial.simulation().state();
            still.time = 0;
            Trial up(method, scene_of(setup, method));
            up.set(still);
            up.advance_for(6);
            double weight = 0;
            for (int s = 0; s < 2; ++s)
                for (double m : rest_state_of(up.scene(), s).mass) weight += 9.81 * m;
            const Work work = up.simulation().work();
            EXPECT_NEAR(work.roots + work.terms, weight * lift, 2e-3 * weight * lift)
                << precision << k_over_m;
            EXPECT_NEAR(up.total() - up.start, weight * lift, 2e-3 * weight * lift) << precision << k_over_m;
        }
}

// Forces on its two particles, and the torque of its frame: without either the balance stays open however
// short the step.
TEST(Work, of_a_driven_root_is_what_an_undamped_curl_gains) {
    const StabilityMethod method = ours();
    std::vector<double> missing;
    for (double dt : {1.0 / 2400, 1.0 / 4800, 1.0 / 9600}) {
        StrandSetup setup{{helix_points(50, 0.25, 0.006, 0.025)}, 1e5, dt, 0, {0, 0, 0}, 0, "", {}};
        setup.more = "[motion]\nangle = 40\naxis = [0, 1, 0]\nperiod = 0.5\n";
        Trial trial(method, scene_of(setup, method));
        trial.advance_for(0.25);
        EXPECT_GT(std::abs(trial.simulation().work().roots), 1e-9);
        missing.push_back(std::abs(trial.total() - trial.start - trial.simulation().work().given()) /
                          trial.scale);
        std::printf("driven curl, dt 1/%.0f s: energy less work %.4f of the largest\n", 1 / dt,
                    missing.back());
    }
    EXPECT_LT(missing.back(), 0.05);
    EXPECT_LT(missing[2], 0.7 * missing[0]);
}

// A strand along the wind, held by its root: c L u² t.
TEST(Work, of_the_wind_on_still_hair_is_drag_times_its_way) {
    for (const char* precision : {"double", "float"}) {
        const StabilityMethod method = ours(precision);
        StrandSetup setup{{straight_points(50, 0.25, {0, -1, 0})}, 1e7, 1.0 / 240, 0, {0, 0, 0}, 0, "", {}};
        setup.more = "[air]\ngrid = [8, 8, 8]\nwind = [0, -2, 0]\ndrag = 1e-4\n";
        Trial trial(method, scene_of(setup, method));
        trial.advance_for(0.5);
        const double given = 1e-4 * 0.25 * 4 * 0.5;
        EXPECT_NEAR(trial.simulation().work().wind, given, 0.02 * given) << precision;
        EXPECT_GT(trial.total() - trial.start, 1e-12) << precision;  // from where, were it not counted
        EXPECT_LE(trial.energy_ratio(), energy_bound) << precision;
    }
}

TEST(Work, of_a_still_solid_is_none) {
    const StabilityMethod method = ours();
    StrandSetup setup{{helix_points(50, 0.25, 0.006, 0.025)}, 1e5, 1.0 / 240, 0, {0, -9.81, 0}, 5, "", {}};
    setup.more = "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntranslation = [0.02, -0.2, 0]\n";
    Trial trial(method, scene_of(setup, method));
    trial.advance_for(1);
    EXPECT_EQ(trial.simulation().work().solids, 0);
}

TEST(State, restored_goes_on_to_the_same_bits) {
    for (const char* precision : {"double", "float"}) {
        const StabilityMethod method = ours(precision);
        StrandSetup setup{{straight_points(30, 0.2, {0, -1, 0}), helix_points(30, 0.2, 0.006, 0.025)},
                          1e5,
                          1.0 / 240,
                          0,
                          {3, -9.81, 0},
                          1,
                          "",
                          {}};
        setup.more = "[[solid]]\nradius = 0.05\n[solid.motion]\nshift = [0.1, 0, 0]\nperiod = 0.4\n";
        Trial a(method, scene_of(setup, method)), b(method, scene_of(setup, method));
        a.advance_for(0.3);
        b.set(a.simulation().state());
        EXPECT_GT(farthest(a.simulation().state().x, straight_points(60, 0.2, {0, -1, 0})), 0.01);
        a.advance_for(0.3);
        b.advance_for(0.3);
        EXPECT_EQ(farthest(a.simulation().state().x, b.simulation().state().x), 0);
    }
}

}  // namespace
}  // namespace wetcurl
