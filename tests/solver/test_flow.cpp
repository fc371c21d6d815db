// Water that lives, against analysis: diffusion's rate and order, the drained film of Jeffreys 1930, the
// profile at rest, drying, exchange, the balance of all of it, and what of a simulation follows it.
#include <cmath>
#include <numbers>
#include <numeric>

#include "solver/chain/scene_checks.h"
#include "solver/water/flow_pass.h"
#include "tests/base/threads.h"
#include "tests/solver/one_strand.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;
using std::numbers::pi;

constexpr double mu = 6.5e-6, absorbed = 0.3;  // [kg/m], m_absorbed
const Vec3d earth{0, -9.81, 0}, nowhere{0, 0, 0};

// Nothing flows but what a test asks for.
Flow still() {
    Flow flow{};
    flow.reach = 0.002;
    return flow;
}
// `count` strands of n particles from the height `length` [m] down to 0, `apart` from each other [m].
Strands hanging(int n, double length, int count = 1, double apart = 0.1) {
    Strands p(count, n);
    for (int s = 0; s < count; ++s)
        for (int i = 0; i < n; ++i) p.at(s, i) = {float(s * apart), float(length * (n - 1 - i) / (n - 1)), 0};
    return p;
}
FlowPass pass_of(const Flow& flow, const Strands& p, const std::vector<double>& sigma) {
    FlowPass pass(flow, FlowHair(p, mu), absorbed, std::vector<float>(p.points.size()));
    pass.restore(sigma);
    return pass;
}
double total(const FlowPass& pass) {
    double sum = 0;
    for (size_t k = 0; k < pass.exact().size(); ++k) sum += pass.dry_mass()[k] * pass.exact()[k];
    return absorbed * sum;
}
void print_orders(const char* what, const std::vector<double>& errors) {
    std::printf("%s: errors", what);
    for (double e : errors) std::printf(" %.3g", e);
    std::printf(", orders");
    for (size_t k = 1; k < errors.size(); ++k) std::printf(" %.2f", std::log2(errors[k - 1] / errors[k]));
    std::printf("\n");
}

// --- along the strand

TEST(Flow, a_small_wave_of_saturation_dies_as_capillary_diffusion_says_to_second_order) {
    Flow flow = still();
    flow.K = 0.01, flow.H = 0.1;
    const double length = 0.1, level = 0.5, size = 1e-3, end = 4;
    const double rate = flow.K * flow.H * level * level * level * std::pow(pi / length, 2);
    std::vector<double> errors;
    for (int n : {11, 21, 41}) {
        const Strands p = hanging(n, length);
        std::vector<double> sigma, mode;
        for (int i = 0; i < n; ++i) {
            mode.push_back(std::cos(pi * i / (n - 1)));
            sigma.push_back(level + size * mode.back());
        }
        FlowPass pass = pass_of(flow, p, sigma);
        // The step goes with the square of the segment, so that its first order does not show.
        const int steps = (n - 1) * (n - 1);
        for (int k = 0; k < steps; ++k) pass.run_along(p, end / steps, nowhere);
        double wave = 0, norm = 0;
        for (size_t i = 0; i < mode.size(); ++i) {
            wave += pass.dry_mass()[i] * mode[i] * (pass.exact()[i] - level);
            norm += pass.dry_mass()[i] * mode[i] * mode[i];
        }
        errors.push_back(std::abs(wave / norm / size / std::exp(-rate * end) - 1));
    }
    print_orders("diffusion", errors);
    ASSERT_GT(rate * end, 0.4);  // there is something to die
    EXPECT_LT(errors.back(), 1e-3);
    for (size_t k = 1; k < errors.size(); ++k) EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 2, 0.1);
}

// sigma_t + (K sigma³)_s = 0 from a full strand: sigma = sqrt(s / (3 K t)) down to where that is 1 (Jeffreys
// 1930).
TEST(Flow, a_full_strand_drains_as_a_film_does) {
    Flow flow = still();
    flow.K = 0.01, flow.dripping = 1;
    const double length = 0.1, dt = 1.0 / 24;
    std::vector<double> errors;
    for (int n : {51, 101, 201, 401}) {
        const Strands p = hanging(n, length);
        FlowPass pass = pass_of(flow, p, std::vector<double>(size_t(n), 1.0));
        for (int k = 0; k < 36; ++k) pass.run_along(p, dt, earth);
        const double t = 36 * dt, front = 3 * flow.K * t;
        ASSERT_LT(front, 0.5 * length);
        double error = 0;
        for (int i = 0; i < n; ++i)
            error +=
                std::abs(pass.exact()[size_t(i)] - std::min(1.0, std::sqrt(length * i / (n - 1) / front)));
        errors.push_back(error / n);
        // Until the front arrives the tip drips as a full one.
        EXPECT_NEAR(pass.water().dripped, absorbed * mu * flow.K * t, 1e-9 * absorbed * mu * flow.K * t);
    }
    print_orders("drainage", errors);
    EXPECT_LT(errors.back(), 5e-3);
    // Upwind: the first order, less a logarithm where the fan begins and ends.
    for (size_t k = 1; k < errors.size(); ++k) EXPECT_GT(std::log2(errors[k - 1] / errors[k]), 0.75);
}

TEST(Flow, at_rest_saturation_rises_downward_by_one_over_the_suction) {
    Flow flow = still();
    flow.K = 0.05, flow.H = 0.2, flow.dripping = 0;
    const int n = 41;
    const double length = 0.1;
    const Strands p = hanging(n, length);
    FlowPass pass = pass_of(flow, p, std::vector<double>(size_t(n), 0.4));
    const double before = total(pass);
    for (int k = 0; k < 2000; ++k) pass.run_along(p, 1.0, earth);
    // Positions are floats.
    for (int i = 0; i + 1 < n; ++i)
        EXPECT_NEAR((pass.exact()[size_t(i) + 1] - pass.exact()[size_t(i)]) * (n - 1) / length, 1 / flow.H,
                    2e-5);
    EXPECT_NEAR(total(pass), before, 1e-13 * before);
    EXPECT_EQ(pass.water().dripped, 0);
}

TEST(Flow, water_on_its_way_down_overfills_nothing) {
    Flow flow = still();
    flow.K = 0.05, flow.H = 0.01;
    const int n = 61;
    const Strands p = hanging(n, 0.2);
    for (double below : {0.0, 0.3, 0.7, 0.95}) {
        std::vector<double> sigma(size_t(n), below);
        std::fill_n(sigma.begin(), n / 2, 1.0);
        FlowPass pass = pass_of(flow, p, sigma);
        const double held = pass.exact()[size_t(n) - 1];
        for (int k = 0; k < 12; ++k) pass.run_along(p, 1.0 / 24, earth);
        EXPECT_GE(pass.exact()[size_t(n) - 1], held);
        // A closed tip takes its share of what is there already, and no more.
        const double tip = below * below * below * flow.K * 0.5 * mu * absorbed;
        EXPECT_LE(pass.water().dripped, 1.01 * tip) << below;
        EXPECT_NEAR(pass.water().balance(), 0, 1e-14 * pass.water().start);
    }
}

TEST(Flow, a_tip_that_points_upward_or_is_closed_keeps_its_water) {
    Flow flow = still();
    flow.K = 0.02, flow.dripping = 1;
    const Strands p = hanging(21, 0.1);
    for (bool upward : {false, true}) {
        flow.dripping = upward;
        FlowPass pass = pass_of(flow, p, std::vector<double>(21, 0.2));
        for (int k = 0; k < 6; ++k) pass.run_along(p, 1.0 / 24, upward ? -1.0 * earth : earth);
        EXPECT_EQ(pass.water().dripped, 0);
        EXPECT_GT(pass.exact()[upward ? 0 : 20], 0.2);
        EXPECT_LT(pass.exact()[upward ? 20 : 0], 0.2);
    }
}

// --- the other stages

TEST(Flow, drying_is_exponential_to_rounding) {
    Flow flow = still();
    flow.drying = 0.7;
    const Strands p = hanging(5, 0.1);
    FlowPass pass = pass_of(flow, p, {0.1, 0.3, 0.5, 0.7, 1});
    const double before = total(pass);
    for (int k = 0; k < 48; ++k) pass.dry(1.0 / 24);
    EXPECT_NEAR(pass.exact()[1], 0.3 * std::exp(-1.4), 1e-14);
    EXPECT_NEAR(pass.exact()[4], std::exp(-1.4), 1e-14);
    EXPECT_NEAR(pass.water().dried, before * (1 - std::exp(-1.4)), 1e-14 * before);
}

TEST(Flow, two_particles_in_touch_relax_to_their_mean_at_the_rate) {
    Flow flow = still();
    flow.exchange = 3;
    // Tips 0.6 mm from each other, roots far from each other; masses of one to three.
    Strands p(2, 2);
    p.at(0, 0) = {0, 0.06f, 0}, p.at(0, 1) = {0, 0, 0};
    p.at(1, 0) = {0, -0.0206f, 0}, p.at(1, 1) = {0, -0.0006f, 0};
    FlowPass pass = pass_of(flow, p, {0.5, 1, 0.5, 0});
    const double mean = 0.75, rate = flow.exchange * kernel_shape(0.0006, flow.reach);
    ASSERT_NEAR(pass.dry_mass()[1] / pass.dry_mass()[3], 3, 1e-6);
    ASSERT_GT(rate, 1);
    for (int k = 1; k <= 48; ++k) {
        pass.step(p, 0, 1.0 / 24, nowhere);
        const double left = std::exp(-rate * k / 24);
        // The distance is one of floats.
        EXPECT_NEAR(pass.exact()[1], mean + 0.25 * left, 1e-6);
        EXPECT_NEAR(pass.exact()[3], mean - 0.75 * left, 1e-6);
    }
    EXPECT_EQ(pass.exact()[0], 0.5);
    EXPECT_NEAR(pass.water().balance(), 0, 1e-15 * pass.water().start);
}

TEST(Flow, many_in_touch_even_out_at_any_rate_and_none_takes_more_than_there_is) {
    Flow flow = still();
    flow.exchange = 1e4, flow.reach = 0.05;
    const Strands p = hanging(12, 0.1, 9, 0.002);
    std::vector<double> sigma(p.points.size(), 0.1);
    for (size_t k = 0; k < sigma.size(); k += 5) sigma[k] = 0.9;
    FlowPass pass = pass_of(flow, p, sigma);
    double low = 0.1, high = 0.9;
    for (int k = 0; k < 6; ++k) {
        pass.step(p, 0, 1, nowhere);
        const auto [least, most] = std::minmax_element(pass.exact().begin(), pass.exact().end());
        EXPECT_GE(*least, low - 1e-15);
        EXPECT_LE(*most, high + 1e-15);
        low = *least, high = *most;
    }
    EXPECT_LT(high - low, 0.2);
    EXPECT_EQ(pass.water().dripped, 0);
}

TEST(Flow, a_source_wets_what_is_inside_it_while_it_flows) {
    Flow flow = still();
    WaterSource plane{};
    plane.rate = 2, plane.from = 0.5, plane.until = 1, plane.shape = Plane{}, plane.center = {0, 0.05, 0};
    flow.sources = {plane};
    const Strands p = hanging(11, 0.1);
    FlowPass pass = pass_of(flow, p, std::vector<double>(11, 0.25));
    for (int k = 0; k < 48; ++k) pass.wet(p, k / 24.0, 1.0 / 24);
    EXPECT_EQ(pass.exact()[2], 0.25);
    EXPECT_NEAR(pass.exact()[8], 1 - 0.75 * std::exp(-1.0), 1e-14);
    EXPECT_NEAR(pass.water().balance(), 0, 1e-15 * pass.water().start);
    EXPECT_GT(pass.water().taken, 0.1 * pass.water().start);
}

// --- all at once

// Curls that touch, with an edge of no length, under wild parameters.
TEST(Flow, saturation_stays_within_bounds_and_water_in_balance_whatever_the_parameters_and_the_step) {
    Random random(11);
    auto number = [&](double most) { return 0.5 * most * (random.vector(1).x + 1); };
    double worst = 0, most_moved = 0;
    for (int trial = 0; trial < 200; ++trial) {
        Flow flow{};
        flow.K = std::pow(10, number(6) - 6), flow.H = std::pow(10, number(6) - 5);
        flow.dripping = number(1), flow.drying = trial % 3 ? 0 : std::pow(10, number(5) - 2);
        flow.exchange = std::pow(10, number(6) - 2), flow.reach = 0.02;
        WaterSource ball{};
        ball.rate = std::pow(10, number(8) - 2), ball.until = 10, ball.shape = Sphere{0.03};
        flow.sources = {ball};
        Strands p(9, 30);
        for (int s = 0; s < p.count; ++s)
            for (int i = 0; i < p.particles; ++i)
                p.at(s, i) = cast<float>(Vec3d{0.01 * (s % 3) + 0.01 * std::sin(0.7 * i), -0.003 * i,
                                               0.01 * (s / 3) + 0.01 * std::cos(0.7 * i)});
        p.at(3, 12) = p.at(3, 11);
        std::vector<double> sigma(p.points.size());
        for (auto& s : sigma) s = trial % 2 ? std::round(number(1)) : number(1);
        FlowPass pass = pass_of(flow, p, sigma);
        const double dt = std::pow(10, number(7) - 4);
        for (int k = 0; k < 20; ++k) pass.step(p, k, dt, earth);
        for (double s : pass.exact()) ASSERT_TRUE(s >= 0 && s <= 1) << s << ", trial " << trial;
        const WaterBalance w = pass.water();
        worst = std::max(worst, std::abs(w.balance()) / (w.start + w.taken));
        most_moved = std::max(most_moved, w.dripped + w.dried);
    }
    std::printf("balance within %.2g of the water that was there\n", worst);
    EXPECT_GT(most_moved, 1e-9);  // [kg]
    EXPECT_LE(worst, 1e-12);
}

// --- whole simulations

const std::string flowing = flowing_scene(0.05, 0.2);
const std::vector<std::string> half_wet{"wetness.level=0.5"};

TEST(Flow, of_a_whole_simulation_keeps_its_balance_and_shows_what_it_holds) {
    const Scene scene = scene_of(flowing, half_wet);
    const auto simulation = make_simulation(scene, "float");
    RunFrame frame;
    for (int f = 0; f < 24; ++f) simulation->advance();
    simulation->snapshot(frame);
    const WaterBalance w = *simulation->water();
    std::printf("balance %.2g of %.3g kg\n", w.balance(), w.start + w.taken);
    for (double part : {w.held, w.taken, w.dripped, w.dried}) EXPECT_GT(part, 0.01 * w.start);
    EXPECT_LE(std::abs(w.balance()), 1e-12 * (w.start + w.taken));
    EXPECT_EQ(frame.water, (std::vector<double>{w.held, w.taken, w.dripped, w.dried}));
    EXPECT_EQ(frame.saturation.size(), scene.saturation.size());
    EXPECT_NE(frame.saturation, scene.saturation);
}

TEST(Flow, gives_the_same_bits_for_one_and_three_threads) {
    for (const char* precision : {"float", "double"}) {
        const Scene scene = scene_of(flowing, {"wetness.level=0.5", "groom.grid=[6, 6]"});
        const auto [one, three] = with_one_and_three_threads([&] { return after(scene, 6, precision); });
        EXPECT_EQ(one.saturation, three.saturation);
        EXPECT_EQ(one.water, three.water);
        EXPECT_TRUE(same_bits(one.seen(), three.seen()));
        EXPECT_NE(one.saturation, scene.saturation);
    }
}

// Eq 10 draws strands together from farther away than it looks.
TEST(Flow, strands_that_are_seen_together_touch) {
    const Scene scene = scene_of(flowing, half_wet);
    const auto simulation = make_simulation(scene, "double");
    RunFrame start, frame;
    simulation->snapshot(start), simulation->advance(), simulation->snapshot(frame);
    auto passed = [&](const Strands& p) {
        FlowPass pass(*scene.flow, FlowHair(scene), scene.wetness->absorbed, scene.saturation);
        pass.step(p, 0, 1 / scene.fps, scene.integrator.gravity);
        double most = 0;
        for (size_t k = 0; k < frame.saturation.size(); ++k)
            most = std::max(most, std::abs(pass.exact()[k] - double(frame.saturation[k])));
        return most;
    };
    EXPECT_LT(passed(start.displayed), 1e-6);
    EXPECT_GT(passed(start.positions), 1e-3);
}

TEST(Flow, all_that_reads_saturation_reads_the_living_one) {
    // Drenched within a frame, and the same strands as a scene that is wet from the start.
    const std::string drench = R"([wetness.flow]
conductivity = 0
drying = 0
exchange = 0
[[wetness.source]]
rate = 1e6
center = [0, 10, 0]
)";
    const std::vector<std::string> printed{"curl.form='printed'", "curl.radius=0.008", "curl.pitch=0.02"};
    std::string uncurled = wet_scene;
    uncurled.erase(uncurled.find("[curl]\n"), 7);
    for (const auto& [text, more] : std::vector<std::pair<std::string, std::vector<std::string>>>{
             {wet_scene, {}}, {wet_scene, printed}, {uncurled, {}}}) {
        auto dry = more, wet = more;
        dry.insert(dry.end(), {"wetness.level=0", "wetness.jitter=0"});
        wet.push_back("wetness.jitter=0");
        const Scene becoming = scene_of(text + drench, dry), being = scene_of(text, wet),
                    staying = scene_of(text, dry);
        const auto a = make_simulation(becoming, "double"), b = make_simulation(being, "double"),
                   c = make_simulation(staying, "double");
        a->advance();
        b->restore(a->state()), c->restore(a->state());
        RunFrame seen[2];
        a->snapshot(seen[0]), b->snapshot(seen[1]);
        EXPECT_EQ(seen[0].saturation, being.saturation);
        EXPECT_GT(farthest(seen[0].displayed, seen[0].positions), 1e-3);
        EXPECT_TRUE(same_bits(seen[0].displayed, seen[1].displayed));
        const auto e = a->energy(), wanted = b->energy();
        for (size_t kind = 0; kind < e.size(); ++kind) {
            EXPECT_NEAR(e[kind], wanted[kind], 1e-12 * std::abs(wanted[kind])) << a->energy_kinds[kind];
        }
        EXPECT_GT(std::abs(e[1]), 1.1 * std::abs(c->energy()[1]));  // of gravity: it weighs more
        // And on from there they move alike: adhesion and drag read it as well.
        for (int f = 0; f < 4; ++f) a->advance(), b->advance();
        a->snapshot(seen[0]), b->snapshot(seen[1]);
        EXPECT_TRUE(same_bits(seen[0].seen(), seen[1].seen()));
    }
}

TEST(Flow, a_state_carries_its_saturation) {
    const Scene scene = scene_of(flowing, half_wet);
    const auto a = make_simulation(scene, "double"), b = make_simulation(scene, "double");
    for (int f = 0; f < 4; ++f) a->advance();
    b->restore(a->state());
    RunFrame frames[2];
    for (int f = 0; f < 4; ++f) a->advance(), b->advance();
    a->snapshot(frames[0]), b->snapshot(frames[1]);
    EXPECT_EQ(frames[0].saturation, frames[1].saturation);
    EXPECT_TRUE(same_bits(frames[0].seen(), frames[1].seen()));
    EXPECT_LE(std::abs(b->water()->balance()), 1e-12 * b->water()->start);
}

// What the water brings is counted, and no more comes out of it.
TEST(Flow, mass_that_comes_and_goes_feeds_no_energy) {
    const std::string shower = R"([wetness]
level = 0.1
absorbed = 3
[curl]
[wetness.flow]
drying = 0.5
[[wetness.source]]
shape = "sphere"
radius = 0.5
until = 0.5
)";
    for (const char* rate : {"rate = 1\n", "rate = 5\n", "rate = 50\n"}) {
        const Scene scene = scene_of(dry_scene + shower + rate);
        const auto simulation = make_simulation(scene, "double");
        simulation->count_work();
        auto sum = [&] {
            const auto e = simulation->energy();
            return std::accumulate(e.begin(), e.end(), 0.0);
        };
        const double start = sum();
        double excess = 0, scale = 0;
        for (int f = 0; f < 24; ++f) {
            simulation->advance();
            const double given = simulation->work().given();
            excess = std::max(excess, sum() - start - given);
            scale = std::max(scale, simulation->energy()[0] + std::abs(given));
        }
        EXPECT_GT(simulation->work().water, 0.3 * scale) << rate;
        EXPECT_LE(excess, 1e-3 * scale) << rate;  // S2
    }
}

TEST(Flow, is_not_there_where_it_is_not_named) {
    auto lists = [](const std::string& text) {
        const Scene scene = scene_of(text);
        const auto simulation = make_simulation(scene, "float");
        std::string all;
        for (const auto& b : simulation->buffers()) all += b.name + "\n";
        for (const auto& s : simulation->stages) all += "stage " + s + "\n";
        for (const auto& p : presence_of(scene).present) all += "present " + p + "\n";
        return all;
    };
    const std::string with = lists(flowing), without = lists(wet_scene);
    std::string stripped = with;
    for (const std::string name :
         {"flow of water\n", "rest states dry\n", "stage saturation\n", "present flow\n"}) {
        EXPECT_EQ(without.find(name), std::string::npos) << name;
        ASSERT_NE(stripped.find(name), std::string::npos) << name;
        stripped.erase(stripped.find(name), name.size());
    }
    EXPECT_EQ(stripped, without);
    const Scene scene = scene_of(wet_scene);
    const RunFrame frame = after(scene, 1);
    EXPECT_TRUE(frame.saturation.empty() && frame.water.empty());
    EXPECT_FALSE(make_simulation(scene, "float")->water());
}

TEST(Flow, bad_values_name_file_and_line) {
    const std::string head = "[groom]\ngrid = [2, 2]\nparticles = 8\n[wetness]\n";
    auto misuse = [&](const std::string& text, const char* line, const std::string& said) {
        SCOPED_TRACE(text);
        expect_error<Misuse>([&] { scene_of(head + text); }, {line, said});
    };
    const std::string source = "[wetness.flow]\n[[wetness.source]]\n";
    misuse(source + "shape = \"spere\"", "scene.toml:7", "did you mean 'sphere'");
    misuse(source + "radius = 0.1", "scene.toml:7", "radius");  // a sphere's, unused by a plane
    misuse(source + "from = 2\nuntil = 1", "scene.toml:8", "must end after");
    misuse(source + "centre = [0, 0, 0]", "scene.toml:7", "did you mean 'center'");
    misuse(source + "center = [0, 0]", "scene.toml:7", "3 numbers");
    misuse("[wetness.flow]\nsources = 1", "scene.toml:6", "unknown");
    misuse("[[wetness.source]]\n", "scene.toml:5", "needs [wetness.flow]");
    misuse("[wetness.flow]\n[baseline]\nmethod = \"kim\"", "scene.toml:5", "leave [wetness.flow] out");
}

}  // namespace
}  // namespace wetcurl
