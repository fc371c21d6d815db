// The cases S1 to S9.
#include "solver/stability/battery.h"

#include <algorithm>
#include <array>
#include <Eigen/Eigenvalues>
#include <random>

#include "solver/stability/trial.h"

namespace wetcurl {

namespace {

// Half decades upwards.
std::vector<Figures> decades_of(const Figures& from, int count) {
    std::vector<Figures> all;
    for (int k = 0; k < count; ++k) {
        all.push_back(from);
        for (auto& [key, value] : all.back()) value *= (k % 2 ? 3 : 1) * std::pow(10.0, k / 2);
    }
    return all;
}
// Its forces on wet hair in the place of ours, on our chain.
StabilityMethod compared(const std::string& name, std::vector<Figures> sweep) {
    StabilityMethod m{.name = name, .integrator = "implicit double", .precision = "double", .settings = {}};
    m.dry = false;
    m.on_solids = name == "boundary_particles", m.on_strands = !m.on_solids;
    (m.on_solids ? m.adhesion : m.cohesion) = "[baseline]\nmethod = \"" + name + "\"\n";
    m.sweep = std::move(sweep);
    return m;
}

}  // namespace

const std::vector<StabilityMethod>& stability_methods() {
    static const std::vector<std::string> printed{"integrator.kind='explicit'", "bend.form='printed'",
                                                  "core.form='printed'"};
    static const std::vector<StabilityMethod> methods{
        {"ours", "implicit double", "double", {}, 2, {}, {}},
        {"ours", "implicit float", "float", {}, 2, {}, {}},
        {"printed", "explicit double", "double", printed, 1, {}, {}},
        {.name = "iben",
         .integrator = "explicit double",
         .precision = "double",
         .settings = {"baseline.method='iben'"},
         .order = 1,
         .on_strands = false,
         .on_solids = false,
         .takes_drag = false,
         .sweep = decades_of({{"velocity_limit", 0.03}}, 7)},
        compared("lin", decades_of({{"strength", 10}}, 9)),
        compared("kim", decades_of({{"strength", 1}, {"area", 1e-3}}, 9)),
        compared("boundary_particles", decades_of({{"strength", 1}}, 9)),
    };
    return methods;
}

namespace {

using Cases = std::vector<StabilityCase>;
constexpr double dt_usual = 1.0 / 240, length = 0.25;
constexpr int particles = 50;
const Vec3d down{0, -9.81, 0}, weightless{0, 0, 0};

const Points straight = straight_points(particles, length, {0, -1, 0});
const Points curly = helix_points(particles, length, 0.006, 0.025);

// What all groups of cases know.
struct Battery {
    const StabilityMethod& method;
    StabilityOptions options;

    StabilityCase named(const char* id, const std::string& what, Figures parameters) const {
        StabilityCase c;
        c.id = id, c.what = what, c.method = &method, c.parameters = std::move(parameters);
        return c;
    }
    std::vector<double> some(std::vector<double> all, std::vector<double> few) const {
        return options.quick ? few : all;
    }
    // Of S1: 1e-6 of a segment is below one ulp in single [m].
    double noise() const { return (method.precision == "double" ? 1e-6 : 1e-3) * length / (particles - 1); }
};

// Wet curls beside each other, one amid six, none turned as another and each in reach of its neighbours only.
StrandSetup wet_lock(const Battery& b, double k_over_m) {
    StrandSetup lock{{}, k_over_m, dt_usual, 0, down, 0, "[wetness]\n" + b.method.cohesion, {}};
    const Points curl = helix_points(particles, length, 0.002, 0.02);
    for (int k = 0; k < 7; ++k) {
        const double angle = k * std::numbers::pi / 3, apart = k == 0 ? 0 : 0.008;  // [m]
        Points& strand = lock.shapes.emplace_back(curl);
        for (auto& p : strand)
            p = rotate(rotation_about({0, 1, 0}, 0.9 * k), p) +
                Vec3d{apart * std::cos(angle), 0, apart * std::sin(angle)};
    }
    return lock;
}

// --- S1

// Noise is put on the trial, which then goes on for `seconds` beside the positions without noise.
template <class Quiet>
void judge_noise(StabilityCase& c, const Battery& b, Trial& trial, double seconds, Quiet quiet) {
    SimulationState s = trial.simulation().state();
    add_noise(s, particles, b.noise(), 4);
    trial.set(s);
    c.gain = 0;
    for (long k = std::lround(seconds * trial.scene().fps); k > 0 && trial.finite && c.gain < 1e6; --k) {
        trial.advance();
        c.gain = std::max(c.gain, farthest(trial.simulation().state().x, quiet()) / b.noise());
    }
    trial.report(c);
    c.passed = c.finite && c.gain <= 100;
}

StabilityCase noise_at_rest(const Battery& b, double k_over_m, double dt) {
    StabilityCase c =
        b.named("S1", "noise at rest, straight and curly", {{"k_over_m", k_over_m}, {"dt", dt}});
    StrandSetup setup{{straight, curly}, k_over_m, dt, 0, weightless, 0, "", {}};
    Trial trial(b.method, scene_of(setup, b.method));
    const auto rest = trial.simulation().state().x;
    judge_noise(c, b, trial, 10, [&] { return rest; });
    return c;
}

// Those that are drawn together come to rest first. Beside a copy without noise, since not all forces leave
// them a place to rest.
StabilityCase noise_beside_neighbours(const Battery& b, double k_over_m) {
    StabilityCase c =
        b.named("S1", "noise beside wet neighbours", {{"k_over_m", k_over_m}, {"dt", dt_usual}});
    StrandSetup free = wet_lock(b, k_over_m);
    free.gravity = weightless;
    StrandSetup settling = free;
    settling.drag = 20;
    Trial quiet(b.method, scene_of(settling, b.method)), noisy(b.method, scene_of(free, b.method));
    quiet.advance_for(6);
    quiet.go_on_in(scene_of(free, b.method));
    noisy.set(quiet.simulation().state());
    judge_noise(c, b, noisy, b.options.quick ? 2 : 10, [&] {
        quiet.advance();
        return quiet.simulation().state().x;
    });
    return c;
}

// --- S2

void judge_energy(StabilityCase& c, const Trial& trial) {
    trial.report(c);
    c.passed = c.finite && c.energy_ratio <= energy_bound;
}

StabilityCase energy_of(const Battery& b, const std::string& what, StrandSetup setup, double angle,
                        double seconds) {
    StabilityCase c =
        b.named("S2", what, {{"k_over_m", setup.k_over_m}, {"dt", setup.dt}, {"limiter", setup.limiter}});
    Trial trial(b.method, scene_of(setup, b.method));
    if (angle > 0) {
        SimulationState s = trial.simulation().state();
        sway(s, particles, angle);
        trial.set(s);
    }
    trial.advance_for(seconds);
    judge_energy(c, trial);
    return c;
}

const char* const shaken = "[motion]\nangle = 40\naxis = [0, 0, 1]\nshift = [0.02, 0.03, 0]\nperiod = 0.5\n";
const char* const still_ball =
    "[[solid]]\nradius = 0.05\nfriction = 0\n[[solid.motion.keyframe]]\ntranslation = [0.0, -0.25, 0.02]\n";
const char* const moving_ball =
    "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntime = 0.1\ntranslation = [0.2, -0.2, 0.01]\n"
    "[[solid.motion.keyframe]]\ntime = 1.1\ntranslation = [-0.2, -0.2, 0.01]\n";

StabilityCase energy_of_wetting(const Battery& b, double k_over_m) {
    StabilityCase c =
        b.named("S2", "wetted and dried in a swing", {{"k_over_m", k_over_m}, {"dt", dt_usual}});
    StrandSetup dry{{straight, curly}, k_over_m, dt_usual, 0, down, 0, "", {}}, wet = dry;
    wet.more = "[wetness]\nabsorbed = 1\n";
    Trial trial(b.method, scene_of(dry, b.method));
    SimulationState s = trial.simulation().state();
    sway(s, particles, 0.5);
    trial.set(s);
    for (const auto* next : {&wet, &dry, &wet}) {
        trial.advance_for(0.3);
        trial.go_on_in(scene_of(*next, b.method));
    }
    trial.advance_for(0.5);
    judge_energy(c, trial);
    return c;
}

Cases energies_of(const Battery& b, double k_over_m) {
    Cases out;
    const double seconds = b.options.quick ? 1 : 4;
    for (double limiter : {0.0, 0.1}) {
        const StrandSetup free{{straight, curly}, k_over_m, dt_usual, limiter, weightless, 0, "", {}};
        StrandSetup hanging = free;
        hanging.gravity = down;
        out.push_back(energy_of(b, "small sway", free, 0.03, seconds));
        out.push_back(energy_of(b, "large sway", free, 1.5, seconds));
        out.push_back(energy_of(b, "fall", hanging, 0, seconds));
        hanging.more = shaken;
        out.push_back(energy_of(b, "shaken root", hanging, 0, seconds));
        hanging.more = still_ball;
        out.push_back(energy_of(b, "swing against a still ball", hanging, 1.0, seconds));
        hanging.more = moving_ball;
        out.push_back(energy_of(b, "swept by a ball", hanging, 0, seconds));
    }
    out.push_back(energy_of_wetting(b, k_over_m));
    return out;
}

// What draws wet strands is either an energy that is kept, and counted, or gives nothing.
Cases energies_of_wet(const Battery& b, double k_over_m) {
    Cases out;
    const double seconds = b.options.quick ? 1 : 4;
    if (b.method.on_strands) {
        StrandSetup lock = wet_lock(b, k_over_m);
        out.push_back(energy_of(b, "wet lock released", lock, 0, seconds));
        out.push_back(energy_of(b, "wet lock in a large sway", lock, 1.5, seconds));
        lock.more += shaken;
        out.push_back(energy_of(b, "wet lock, shaken root", lock, 0, seconds));
    }
    if (b.method.on_solids)
        for (const char* ball : {still_ball, moving_ball}) {
            const StrandSetup at{{straight, curly},
                                 k_over_m,
                                 dt_usual,
                                 0,
                                 down,
                                 0,
                                 "[wetness]\n" + b.method.adhesion + ball,
                                 {}};
            const bool still = ball == still_ball;
            out.push_back(energy_of(b, still ? "wet, swing against a still ball" : "wet, swept by a ball", at,
                                    still ? 1.0 : 0.0, seconds));
        }
    return out;
}

// --- S3

struct Jacobian {
    double asymmetry, lowest;  // over the largest entry, the largest eigenvalue
};
Jacobian looked_at(const Eigen::MatrixXd& m) {
    const Eigen::MatrixXd symmetric = 0.5 * (m + m.transpose());
    const Eigen::VectorXd e =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
    return {(m - m.transpose()).cwiseAbs().maxCoeff() / m.cwiseAbs().maxCoeff(),
            e.minCoeff() / e.cwiseAbs().maxCoeff()};
}

// Forces of all terms at positions `at`, frames carried there, and the matrix where asked for.
Assembled assembled_by(const Battery& b, const ChainTerms& terms, OneStrand& s, const Points& at, double h,
                       bool with_matrix) {
    const size_t n = size_t(s.n);
    const auto frames = s.frames_at(at);
    const ChainView<double> view = s.view_at(at, frames);
    Points force(n, Vec3d{0, 0, 0});
    const Sym3<double> none = identity_times(0.0);
    std::vector<Sym3<double>> diagonal(n, none);
    std::vector<Mat3<double>> upper1(n, to_mat3(none)), upper2(n, to_mat3(none));
    const ChainSystem<double> system{h, force.data(), with_matrix ? diagonal.data() : nullptr, upper1.data(),
                                     upper2.data()};
    if (b.method.assemble)
        b.method.assemble(terms, view, system);
    else
        for_each_present(terms, [&](const auto& term) { assemble(term, view, system); });
    return {stacked(force), with_matrix ? whole(diagonal, upper1, upper2) : Eigen::MatrixXd()};
}

Cases jacobians(const Battery& b, double k_over_m) {
    Cases out;
    for (bool curl : {false, true}) {
        const Points& shape = curl ? curly : straight;
        const std::string of = curl ? ", curly" : ", straight";
        const Scene scene =
            scene_of(StrandSetup{{shape}, k_over_m, dt_usual, 0, weightless, 0, "", {}}, b.method);
        OneStrand s(shape, scene.linear_density);
        const auto& core = *scene.term<Core>();
        s.rest_on(core);

        // Central differences of the forces: those of springs at rest bend over a segment.
        const long size = 3 * s.n;
        const double step = 1e-5 * s.segment();
        Eigen::MatrixXd k(size, size);
        for (long column = 0; column < size; ++column) {
            Eigen::VectorXd at = stacked(s.x);
            Eigen::VectorXd difference = Eigen::VectorXd::Zero(size);
            for (double side : {1.0, -1.0}) {
                at[column] += side * step;
                difference += side * assembled_by(b, scene.chain, s, unstacked(at), 0, false).force;
                at[column] -= side * step;
            }
            k.col(column) = -difference / (2 * step);
        }
        StabilityCase c = b.named("S3", "force differenced at rest" + of, {{"k_over_m", k_over_m}});
        Jacobian j = looked_at(k);
        c.finite = k.allFinite();
        c.measured = {{"asymmetry", j.asymmetry}, {"lowest_eigenvalue", j.lowest}};
        c.passed = c.finite && j.asymmetry <= 1e-6 && j.lowest >= -1e-6;
        out.push_back(c);
        if (scene.integrator.kind != "implicit") continue;

        // Symmetric by the way it is kept, upper half alone; positive it need not be.
        c = b.named("S3", "assembled matrix" + of, {{"k_over_m", k_over_m}});
        std::mt19937 random(7);
        double lowest = 1, asymmetry = 0;
        for (int state = 0; state < 5; ++state) {
            Points at = s.x;
            for (size_t i = 2; i < at.size(); ++i)
                for (double* x : {&at[i].x, &at[i].y, &at[i].z})
                    *x += s.segment() * (2.0 * random() / 4294967295.0 - 1);
            const auto a = assembled_by(b, scene.chain, s, at, dt_usual, true);
            j = looked_at(a.matrix);
            c.finite = c.finite && a.matrix.allFinite();
            lowest = std::min(lowest, j.lowest), asymmetry = std::max(asymmetry, j.asymmetry);
        }
        c.measured = {{"asymmetry", asymmetry}, {"lowest_eigenvalue", lowest}};
        c.passed = c.finite && asymmetry <= 1e-6 && lowest >= -1e-6;
        out.push_back(c);

        // An underestimated Hessian lets a strand swing up; at rest it must be the forces' own, or above.
        c = b.named("S3", "matrix above the force's" + of, {{"k_over_m", k_over_m}});
        const double h = 1;
        const Eigen::MatrixXd own = assembled_by(b, scene.chain, s, s.x, h, true).matrix;
        const Eigen::MatrixXd above = own - 0.5 * (k + k.transpose());
        const Eigen::VectorXd e =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                Eigen::MatrixXd(above.bottomRightCorner(size - 6, size - 6)), Eigen::EigenvaluesOnly)
                .eigenvalues();
        lowest = e.minCoeff() / own.cwiseAbs().maxCoeff();
        c.finite = above.allFinite();
        c.measured = {{"lowest_eigenvalue", lowest}};
        c.passed = c.finite && lowest >= -1e-6;
        out.push_back(c);
    }
    return out;
}

// --- S4

// The hanging chain: edge i of a straight strand extended by s_i, where stretch, bend and core (of the same
// k) carry the weight w_i below it: 2 k s + k D^T D s = w with the core's filter D. Edge 0 is the root's.
Points hanging(const Scene& scene) {
    const int edges = particles - 1;
    const StrandRest rest = rest_state_of(scene, 0);
    const double k_s = scene.term<Stretch>()->k_s, k_b = scene.term<Bend>()->k_b;
    const Core& core = *scene.term<Core>();
    Eigen::MatrixXd d(edges, edges);
    for (int column = 0; column < edges; ++column)
        smooth_edges<double>(
            edges, core.beta,
            [&](int i) {
                return Vec3d{i == column ? 1.0 : 0.0, 0, 0};
            },
            [&](int i, const Vec3d& v) { d(i, column) = v.x; });
    // As printed the core's force is on its own edge alone.
    Eigen::MatrixXd k = core.k_c * (core.printed ? d : Eigen::MatrixXd(d.transpose() * d));
    k += (k_s + k_b) * Eigen::MatrixXd::Identity(edges, edges);
    Eigen::VectorXd w = Eigen::VectorXd::Zero(edges);
    double below = 0;
    for (int i = edges - 1; i >= 1; --i) w[i] = (below += rest.mass[size_t(i) + 1]) * 9.81;
    const Eigen::VectorXd s = k.bottomRightCorner(edges - 1, edges - 1).ldlt().solve(w.tail(edges - 1));
    Points p{rest.start[0], rest.start[1]};
    for (int i = 1; i < edges; ++i) {
        double extension = s[i - 1];
        const double l = rest.rest_length[size_t(i)];
        if (const auto& limit = scene.term<StrainLimit>()) extension = std::min(extension, limit->most * l);
        p.push_back(p.back() + Vec3d{0, -(l + extension), 0});
    }
    return p;
}

// Slowest swing along a strand of n masses held by two springs of k each [rad/s].
double slowest(double k_over_m, int n = particles) {
    return 0.5 * std::numbers::pi / n * std::sqrt(2 * k_over_m);
}

double converged_kinetic(double k_over_m, double seconds) {
    const StabilityMethod ours{"ours", "implicit double", "double", {}, 2, {}, {}};
    Trial trial(ours, scene_of(StrandSetup{{straight}, k_over_m, 1.0 / 9600, 0, down, 0, "", {}}, ours));
    trial.advance_for(seconds);
    return trial.most_kinetic;
}

Cases stiffness_by_step(const Battery& b, double k_over_m) {
    Cases out;
    const double swing = std::clamp(std::numbers::pi / slowest(k_over_m), 1.0, 10.0);
    const double reference = k_over_m < 1e5 ? converged_kinetic(k_over_m, swing) : 0;
    for (double dt : b.some({1.0 / 24, 1.0 / 240, 1.0 / 2400}, {1.0 / 24, 1.0 / 240}))
        for (double limiter : {0.0, 0.1}) {
            StabilityCase c =
                b.named("S4", "released to hang", {{"k_over_m", k_over_m}, {"dt", dt}, {"limiter", limiter}});
            StrandSetup setup{{straight}, k_over_m, dt, limiter, down, 0, "", {}};
            Trial falling(b.method, scene_of(setup, b.method));
            falling.advance_for(swing);
            falling.report(c);
            const double allowed = reference > 0 ? 1.1 * reference : 20 * falling.weight_length();
            c.kinetic_ratio = falling.finite ? falling.most_kinetic / allowed : unbounded;
            c.measured.push_back({"kinetic_over_weight", falling.most_kinetic / falling.weight_length()});

            if (!b.method.takes_drag) {
                c.passed = c.finite && c.kinetic_ratio <= 1;
                out.push_back(c);
                continue;
            }
            // Critically damped, as far as the explicit scheme can take it.
            setup.drag = std::min(2 * slowest(k_over_m), 20.0);
            Trial settling(b.method, scene_of(setup, b.method));
            settling.advance_for(std::max(12 / slowest(k_over_m), 1.5));
            c.finite = c.finite && settling.finite;
            // Of the length that it hangs at: the softest is stretched to hundreds of its own.
            const Points shape = hanging(settling.scene());
            c.rest_error = farthest(settling.simulation().state().x, shape) /
                           arc_length(shape.data(), int(shape.size()));
            c.passed = c.finite && c.kinetic_ratio <= 1 && c.rest_error < 0.01;
            out.push_back(c);
        }
    return out;
}

// --- S5

// Scenes one after the other, then rest.
struct Ordeal {
    std::string what;
    std::vector<StrandSetup> scenes;
    std::vector<double> seconds;
    std::function<void(SimulationState&)> disturb;  // at the start; may be empty
    // The first frame is the ordeal: a solid throws out what was drawn into it, and that bends the strand.
    bool after_first_frame = false;
};

// Stated, with no scheme in mind: what an ordeal may leave unaccounted for is less than what it put in.
constexpr double ordeal_bound = 1, settled_bound = 1e-4;

StabilityCase stood(const Battery& b, const Ordeal& o) {
    const StrandSetup& first = o.scenes.front();
    StabilityCase c =
        b.named("S5", o.what, {{"k_over_m", first.k_over_m}, {"dt", first.dt}, {"limiter", first.limiter}});
    Trial trial(b.method, scene_of(first, b.method));
    if (o.disturb) {
        SimulationState s = trial.simulation().state();
        o.disturb(s);
        trial.set(s);
    }
    if (o.after_first_frame) {
        trial.advance();
        trial.set(trial.simulation().state());
    }
    for (size_t k = 0; k < o.scenes.size(); ++k) {
        if (k > 0) trial.go_on_in(scene_of(o.scenes[k], b.method));
        trial.advance_for(o.seconds[k]);
    }
    trial.report(c);
    c.kinetic_ratio = trial.finite ? trial.kinetic / trial.weight_length() : unbounded;
    c.measured.push_back({"most_kinetic_over_weight", trial.most_kinetic / trial.weight_length()});
    c.passed = c.finite && c.energy_ratio <= ordeal_bound &&
               (!b.method.takes_drag || c.kinetic_ratio <= settled_bound);
    return c;
}

// Drag that damps the slowest swing critically, as far as the explicit scheme can take it, and time for it to
// settle.
double drag_of(double slowest) { return std::min(2 * slowest, 20.0); }
double settle_of(double slowest) { return std::max(12 / slowest, 3.0); }

const char* const turned_root =
    "[motion]\n[[motion.keyframe]]\ntime = 0.1\n[[motion.keyframe]]\ntime = 0.141667\nrotation = "
    "[0, 180, 0]\n";
const char* const pierced =
    "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntranslation = [0.01, -0.22, 0.0]\n";

Cases all_of(const Battery& b, const std::vector<Ordeal>& ordeals) {
    Cases out;
    for (const auto& o : ordeals) out.push_back(stood(b, o));
    return out;
}

Cases ordeals(const Battery& b, double k_over_m, double limiter) {
    const double swing = slowest(k_over_m), settle = settle_of(swing);
    const StrandSetup base{{straight, curly}, k_over_m, dt_usual, limiter, down, drag_of(swing), "", {}};
    std::vector<Ordeal> all;
    auto add = [&](const std::string& what, auto change, std::function<void(SimulationState&)> disturb = {}) {
        StrandSetup setup = base;
        change(setup);
        all.push_back({what, {setup}, {settle}, disturb});
    };
    add("root turned by 180 degrees in a frame", [](StrandSetup& s) { s.more = turned_root; });
    add("10 g", [](StrandSetup& s) { s.gravity = 10 * down; });
    add(
        "zero-length edge", [](StrandSetup&) {},
        [](SimulationState& s) {
            s.x[10] = s.x[9];
            carry_frames(s, particles);
        });
    add("tip inside a solid", [](StrandSetup& s) { s.more = pierced; });
    all.back().after_first_frame = true;
    add("two particles", [](StrandSetup& s) {
        s.shapes = {straight_points(2, 0.01, {0, -1, 0}), straight_points(2, 0.01, {1, 0, 0})};
    });
    // The same fibre of more particles: k goes with their number, m against it.
    const auto refine = [](StrandSetup& s, int n) { s.k_over_m *= std::pow(double(n) / particles, 2); };
    add("curl radius of 2 mm", [&](StrandSetup& s) {
        s.shapes = {helix_points(200, length, 0.002, 0.005)};
        refine(s, 200);
    });
    StrandSetup wet = base;
    wet.more = "[wetness]\nabsorbed = 1\n[curl]\n";
    all.push_back({"dry, wet and dry in a step", {base, wet, base}, {0.5, 0.5, settle}, {}});
    // Segments a thousand times shorter above long ones, wet at the tip: masses from 1 to 1e4.
    const double heavy = slowest(k_over_m / 22);  // a tip's particle: 22 times the mean
    add("mass ratio of 1e4", [&](StrandSetup& s) {
        Points p = straight_points(particles / 2, 2.4e-4 * length, {0, -1, 0});
        while (p.size() < size_t(particles)) p.push_back(p.back() + Vec3d{0, -0.01, 0});
        s.shapes = {p};
        s.more = "[wetness]\nabsorbed = 10\npattern = \"tip\"\n";
        s.drag = drag_of(heavy);
    });
    all.back().seconds = {settle_of(heavy)};
    StrandSetup coarse = base, fine = base;
    coarse.dt = 1.0 / 24, fine.dt = coarse.dt / 100;
    all.push_back(
        {"step a hundred times longer in a swing", {fine, coarse}, {0.3, settle}, [](SimulationState& s) {
             sway(s, particles, 0.5);
         }});
    if (!b.options.quick && limiter == 0)
        add("10,000 particles", [&](StrandSetup& s) {
            s.shapes = {straight_points(10000, length, {0, -1, 0})};
            refine(s, 10000);
        });
    return all_of(b, all);
}

Cases wet_ordeals(const Battery& b, double k_over_m) {
    const double swing = slowest(k_over_m);
    std::vector<Ordeal> all;
    auto add = [&](const std::string& what, StrandSetup setup, const std::string& more = "") {
        setup.drag = drag_of(swing), setup.more += more;
        all.push_back({what, {setup}, {settle_of(swing)}, {}});
    };
    const StrandSetup lock = wet_lock(b, k_over_m);
    if (b.method.on_strands) {
        StrandSetup heavy = lock, together = lock;
        heavy.gravity = 10 * down;
        for (auto& shape : together.shapes) shape = curly;
        add("wet lock, root turned by 180 degrees in a frame", lock, turned_root);
        add("wet lock at 10 g", heavy);
        add("coincident strands", together);
        add("wet lock, step a hundred times longer in a swing", lock);
        Ordeal& longer = all.back();
        longer.scenes.front().dt = 1.0 / 24,
        longer.scenes.insert(longer.scenes.begin(), longer.scenes.front());
        longer.scenes.front().dt /= 100, longer.seconds.insert(longer.seconds.begin(), 0.3);
        longer.disturb = [](SimulationState& s) { sway(s, particles, 0.5); };
    }
    if (b.method.on_solids) {
        StrandSetup at = lock;
        at.shapes = {straight, curly}, at.more = "[wetness]\n" + b.method.adhesion;
        add("wet, tip inside a solid", at, pierced);
        all.back().after_first_frame = true;
    }
    return all_of(b, all);
}

// --- S6

double order_between(double coarse, double fine) { return std::log2(coarse / fine); }

Points swung(const Battery& b, double k_over_m, int steps) {
    StrandSetup setup{{helix_points(20, 0.1, 0.006, 0.025)}, k_over_m, 0.1, 0, {3, -9.81, 2}, 0, "", {}};
    setup.set = {"integrator.substeps=" + std::to_string(steps)};
    Trial trial(b.method, scene_of(setup, b.method));
    trial.advance();
    return trial.simulation().state().x;
}

// Root mean square over the particles [m].
double mean_distance(const Points& a, const Points& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += dot(a[i] - b[i], a[i] - b[i]);
    return std::sqrt(sum / double(a.size()));
}

// Of a swinging curl, over halvings of dt.
StabilityCase order_in_time(const Battery& b, double k_over_m) {
    const bool single = b.method.precision == "float";
    StabilityCase c = b.named("S6", "order in dt of a swinging curl", {{"k_over_m", k_over_m}});
    // Stiff strands need shorter steps to show an order; in single precision steps so short that only
    // rounding is left say nothing.
    const int coarse = k_over_m <= 1e4 ? 200 : 400, halvings = single ? 1 : 2;
    StabilityMethod fine = b.method;
    fine.precision = "double";
    const Points exact = swung({fine, b.options}, k_over_m, 64 * coarse);
    double before = 0, least = unbounded;
    for (int k = 0, steps = coarse; k <= halvings; ++k, steps *= 2) {
        const double error = mean_distance(swung(b, k_over_m, steps), exact);
        if (k > 0) {
            const double order = order_between(before, error);
            c.measured.push_back({"order_at_" + std::to_string(steps) + "_steps", order});
            least = std::min(least, order);
        }
        before = error;
        c.finite = c.finite && std::isfinite(error);
    }
    c.measured.push_back({"least_error_m", before});
    // 1.9 of 2 for BDF2.
    c.passed = c.finite && least >= 0.95 * b.method.order;
    return c;
}

// Droop of a cantilever under its own small weight q a length: q L^4 / 8 EI. First order in the segment,
// since the clamped edge is one (EQUATIONS Sec. 1: (1 + 1/m)(1 + 1/(2m)) for a load at the tip).
StabilityCase order_in_particles(const Battery& b) {
    StabilityCase c = b.named("S6", "order in N of a drooping beam", {});
    const double reach = 0.1, flexural = 1e-9, g = 0.02;  // [m], [N m²], [m/s²]: a droop of 2 mm
    double before = 0, least = unbounded;
    for (int n : {10, 20, 40}) {
        const double l = reach / (n - 2), k = flexural / (l * l * l);
        StrandSetup setup{
            {straight_points(n, (n - 1) * l, {1, 0, 0})}, 0, dt_usual, 0, {0, -g, 0}, 9, "", {}};
        setup.set = {setting("bend.stiffness", k), setting("stretch.stiffness", 100 * k)};
        Trial trial(b.method, scene_of(setup, b.method));
        trial.advance_for(5);
        const double tip = -trial.simulation().state().x.back().y;
        const double ratio = tip / (trial.scene().linear_density * g * std::pow(reach, 4) / (8 * flexural));
        const double error = std::abs(ratio - 1);
        c.measured.push_back({"ratio_of_" + std::to_string(n), ratio});
        if (before > 0) least = std::min(least, order_between(before, error));
        before = error;
        c.finite = c.finite && std::isfinite(tip);
    }
    c.measured.push_back({"order", least});
    c.rest_error = before;
    c.passed = c.finite && least >= 0.9;
    return c;
}

// --- S7

// Plain strands and changed ones, once these are brought back.
StabilityCase invariant(const Battery& b, const std::string& what, const StrandSetup& plain,
                        const StrandSetup& changed, double bound,
                        const std::function<void(Points&)>& bring_back) {
    StabilityCase c = b.named("S7", what, {{"k_over_m", changed.k_over_m}});
    auto run = [&](const StrandSetup& setup, Points* drawn) {
        Trial trial(b.method, scene_of(setup, b.method));
        if (drawn) *drawn = trial.simulation().state().x;
        for (int k = 0; k < 100; ++k) trial.advance();
        return trial.simulation().state().x;
    };
    Points drawn;
    const Points x = run(plain, &drawn);
    Points y = run(changed, nullptr);
    bring_back(y);
    const double moved = farthest(x, drawn) / length;
    c.rest_error = farthest(x, y) / length;
    c.finite = std::isfinite(c.rest_error);
    c.measured = {{"bound", bound}, {"moved", moved}};
    c.passed = c.finite && c.rest_error <= bound && moved > 0.01;
    return c;
}

Cases invariances(const Battery& b, const StrandSetup& plain, const std::string& of) {
    const bool single = b.method.precision == "float";
    auto each = [](auto change) {
        return [change](Points& points) {
            for (auto& p : points) p = change(p);
        };
    };
    Cases out;
    StrandSetup s = plain;
    const Vec3d far{1000, -500, 300};
    s.more += "[motion]\n[[motion.keyframe]]\ntranslation = [1000, -500, 300]\n";
    // An ulp at 1000 m is 1e-13 m in double. In single it is 6e-5 m, a hundredth of a segment.
    out.push_back(invariant(b, "translation by 1 km" + of, plain, s, single ? 0.1 : 1e-6,
                            each([=](const Vec3d& p) { return p - far; })));
    s = plain;
    const Quatd q = rotation_about(normalized(Vec3d{1, 2, 3}, Vec3d{1, 0, 0}), 1.1);
    for (auto& shape : s.shapes)
        for (auto& p : shape) p = rotate(q, p);
    s.gravity = rotate(q, down);
    // Grooms are kept in single: 1e-8 m of each particle, 4e-6 of a segment, and turns of edges add up.
    out.push_back(invariant(b, "rotation" + of, plain, s, 1e-3,
                            each([=](const Vec3d& p) { return rotate(conjugate(q), p); })));
    s = plain;
    std::rotate(s.shapes.begin(), s.shapes.begin() + 1, s.shapes.end());
    // Sums over neighbours are rounded in another order.
    out.push_back(invariant(b, "strand permutation" + of, plain, s, of.empty() ? 0 : 1e-6,
                            [](Points& p) { std::rotate(p.begin(), p.end() - particles, p.end()); }));
    if (!of.empty() || b.method.compared()) return out;  // these have lengths of their own
    s = plain;
    // By a power of two, so that no digit of the groom is lost; k / m has no length in it.
    const double unit = 32;
    for (auto& shape : s.shapes)
        for (auto& p : shape) p = unit * p;
    s.gravity = unit * down;
    s.set = {setting("core.smoothing", 0.02 * unit)};
    out.push_back(invariant(b, "unit of length", plain, s, single ? 1e-3 : 1e-9,
                            each([=](const Vec3d& p) { return (1 / unit) * p; })));
    return out;
}

// --- S8

StabilityCase limiter_honesty(const Battery& b, double k_over_m) {
    StabilityCase c = b.named("S8", "work of the limiter", {{"k_over_m", k_over_m}, {"limiter", 0.1}});
    Trial trial(b.method, scene_of({{straight, curly}, k_over_m, dt_usual, 0.1, down, 0, "", {}}, b.method));
    double before = 0, most = 0, least = 0;
    for (int f = 0; f < 480 && trial.finite; ++f) {
        trial.advance();
        const double sum = trial.simulation().work().limiter;
        most = std::max(most, sum - before), least = std::min(least, sum - before);
        before = sum;
    }
    trial.report(c);
    const double weight = trial.weight_length();
    c.measured.push_back({"sum_over_weight", before / weight});
    c.measured.push_back({"most_in_a_frame_over_weight", most / weight});
    c.measured.push_back({"least_in_a_frame_over_weight", least / weight});
    c.measured.push_back({"limited_edges", double(trial.simulation().limited_edges())});
    // It may take energy; what it gives, S2 must not notice.
    c.passed = c.finite && before <= energy_bound * std::max(trial.scale, 1e-9 * weight);
    return c;
}

// --- S9

const char* const everything = R"([groom]
grid = [6, 6]
particles = 50
[integrator]
substeps = 10
[stretch]
[bend]
[core]
[wetness]
jitter = 0.3
[curl]
[stiffness]
global = 6
[motion]
[[motion.keyframe]]
time = 0.1
[[motion.keyframe]]
time = 0.3
rotation = [0, 40, 0]
[[motion.keyframe]]
time = 0.6
rotation = [0, -40, 10]
[[motion.keyframe]]
time = 0.8
[[solid]]
name = "head"
radius = 0.095
attached = "head"
[[solid]]
name = "ball"
radius = 0.06
[[solid.motion.keyframe]]
time = 0.1
translation = [0.3, -0.1, -0.05]
[[solid.motion.keyframe]]
time = 1.0
translation = [0.15, -0.1, -0.05]
)";

struct SceneText {
    std::string text, name, folder;
    bool has(const char* table) const {
        return text.find(std::string("[") + table + "]") != std::string::npos;
    }
};

// Hair is at rest once its particles move by no more in a frame, in segments.
constexpr double still_enough = 2e-4;

StabilityCase all_at_once(const Battery& b, const SceneText& of, double stiffer, double pull, double radius,
                          double limiter) {
    StabilityCase c = b.named("S9", "everything at once",
                              {{"stiffness_factor", stiffer},
                               {"adhesion", pull},
                               {"cohesion_radius", radius},
                               {"limiter", limiter}});
    std::vector<std::string> set = b.options.set;
    set.push_back(setting("integrator.limiter", limiter));
    if (of.has(Adhesion::table)) set.push_back(setting("adhesion.strength", pull));
    if (of.has(Cohesion::table)) set.push_back(setting("cohesion.radius", radius));
    Scene scene = scene_of(of.text, of.name, of.folder, set, b.method);
    if (auto& t = scene.term<Stretch>()) t->k_s *= stiffer;
    if (auto& t = scene.term<Bend>()) t->k_b *= stiffer;
    if (auto& t = scene.term<Twist>()) t->k_b *= stiffer;
    if (auto& t = scene.term<Core>()) t->k_c *= stiffer;
    Trial trial(b.method, std::move(scene));
    trial.advance_for(6);
    // Soft hair takes long to come to rest.
    const double segment = mean_segment(trial.scene().groom);
    double seconds = 6, moved = unbounded;
    for (; trial.finite && moved > still_enough * segment && seconds < 60; ++seconds) {
        trial.advance_for(1 - 1 / trial.scene().fps);
        const Points before = trial.simulation().state().x;
        trial.advance();
        moved = mean_distance(trial.simulation().state().x, before);
    }
    const double jitter = jitter_of(trial);
    trial.report(c);
    c.kinetic_ratio = trial.finite ? trial.kinetic / trial.weight_length() : unbounded;
    c.measured.push_back({"jitter_over_segment", jitter});
    c.measured.push_back({"seconds_to_rest", seconds});
    c.passed = c.finite && c.energy_ratio <= energy_bound && jitter <= jitter_bound;
    return c;
}

Cases everything_at_once(const Battery& b, double stiffer) {
    SceneText of{everything + b.method.cohesion + b.method.adhesion, "battery", "."};
    if (!b.options.scene.empty()) {
        const Config config = Config::load(b.options.scene);
        of = {config.text(), b.options.scene, config.folder()};
    }
    // Strength of the adhesion [m/s²], radius of the cohesion [m]: over decades, one at a time.
    std::vector<std::pair<double, double>> wet{{60, 0.01}};
    if (!b.options.quick && of.has(Adhesion::table))
        for (double pull : {6.0, 600.0, 6000.0}) wet.push_back({pull, 0.01});
    if (!b.options.quick && of.has(Cohesion::table))
        for (double radius : {0.001, 0.1}) wet.push_back({60, radius});
    Cases out;
    for (double limiter : {0.0, 0.1})
        for (const auto& [pull, radius] : wet)
            out.push_back(all_at_once(b, of, stiffer, pull, radius, limiter));
    return out;
}

}  // namespace

std::vector<StabilityJob> stability_jobs(const StabilityMethod& method, const StabilityOptions& options) {
    const Battery b{method, options};
    std::vector<StabilityJob> jobs;
    auto add = [&](const char* id, std::function<Cases()> run) {
        const auto& only = options.only;
        if (only.empty() || std::find(only.begin(), only.end(), id) != only.end()) jobs.push_back({id, run});
    };
    const bool wet = method.on_strands || method.on_solids;
    if (method.dry) {
        for (double dt : b.some({dt_usual, dt_usual / 10}, {dt_usual}))
            for (double k : b.some({1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10}, {1e3, 1e5, 1e8}))
                add("S1", [=] { return Cases{noise_at_rest(b, k, dt)}; });
        for (double k : b.some({1e3, 1e4, 1e5, 1e6, 1e8, 1e10}, {1e4, 1e7}))
            add("S2", [=] { return energies_of(b, k); });
        for (double k : b.some({1e3, 1e6, 1e10}, {1e5})) add("S3", [=] { return jacobians(b, k); });
        for (double k : b.some({1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e10, 1e12, 1e14}, {1e4, 1e8, 1e14}))
            add("S4", [=] { return stiffness_by_step(b, k); });
        for (double k : b.some({1e4, 1e7, 1e10}, {1e6}))
            for (double limiter : {0.0, 0.1}) add("S5", [=] { return ordeals(b, k, limiter); });
        for (double k : b.some({1e4, 1e5, 1e6}, {1e5})) add("S6", [=] { return Cases{order_in_time(b, k)}; });
        if (method.takes_drag) add("S6", [=] { return Cases{order_in_particles(b)}; });
        for (double k : b.some({1e4, 1e6}, {1e5}))
            add("S7", [=] {
                return invariances(b, {{straight, curly}, k, dt_usual, 0, down, 0, "", {}}, "");
            });
        for (double k : b.some({1e4, 1e6, 1e8}, {1e4}))
            add("S8", [=] { return Cases{limiter_honesty(b, k)}; });
    }
    for (double k : b.some({1e4, 1e6, 1e8}, {1e6})) {
        if (method.on_strands) add("S1", [=] { return Cases{noise_beside_neighbours(b, k)}; });
        if (wet) {
            add("S2", [=] { return energies_of_wet(b, k); });
            add("S5", [=] { return wet_ordeals(b, k); });
        }
    }
    if (method.on_strands) add("S7", [=] { return invariances(b, wet_lock(b, 1e5), ", wet lock"); });
    // A scene that is given names our wet terms.
    if (wet && !(method.compared() && !options.scene.empty()))
        for (double factor : b.some({0.01, 0.1, 1, 10, 100, 1e4}, {1, 100}))
            add("S9", [=] { return everything_at_once(b, factor); });
    return jobs;
}

}  // namespace wetcurl
