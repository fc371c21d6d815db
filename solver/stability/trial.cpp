// Scenes under trial.
#include "solver/stability/trial.h"

#include <cstdio>
#include <numeric>
#include <random>

#include "solver/chain/scene_checks.h"

namespace wetcurl {

std::string setting(const std::string& key, double value) {
    char text[64];
    std::snprintf(text, sizeof text, "=%.17g", value);
    return key + text;
}

Scene scene_of(const std::string& text, const std::string& name, const std::string& folder,
               std::vector<std::string> set, const StabilityMethod& method) {
    const ChainTerms none;
    std::vector<std::string> tables{Wetness::table, Curl::table, Cohesion::table};
    std::apply([&](const auto&... t) { (tables.push_back(std::decay_t<decltype(*t)>::table), ...); }, none);
    for (const auto& s : method.settings) {
        const std::string table = s.substr(0, s.find('.'));
        const bool of_term = std::find(tables.begin(), tables.end(), table) != tables.end();
        if (!of_term || text.find("[" + table + "]") != std::string::npos) set.push_back(s);
    }
    SceneOptions options;
    options.set = set;
    return parse_scene(text, name, folder, options);
}

Scene scene_of(const StrandSetup& s, const StabilityMethod& method) {
    const auto& first = s.shapes.front();
    const double linear_density = 6.5e-6;  // [kg/m], the scenes' default
    double sum = 0;
    for (const auto& shape : s.shapes) sum += arc_length(shape.data(), int(shape.size()));
    const double segment = sum / double(s.shapes.size() * (first.size() - 1));
    const double k = s.k_over_m * linear_density * segment;
    const double fibre = s.fibre > 0 ? s.fibre : method.fibre;
    std::string text = "[groom]\ncurl_radius = 0\n[integrator]\n";
    text += fibre > 0 ? "substeps = 10\n[fibre]\n" + setting("diameter ", fibre) + "\n"
                      : "substeps = 1\n[stretch]\ndamping = 0\n[bend]\ndamping = 0\n[core]\ndamping = 0\n";
    if (s.drag > 0 && method.takes_drag) text += "[stiffness]\nwet = 0\n" + setting("global ", s.drag) + "\n";
    std::vector<std::string> set{setting("fps", 1 / s.dt), setting("integrator.limiter", s.limiter),
                                 "integrator.gravity=[" + setting("", s.gravity.x).substr(1) + "," +
                                     setting("", s.gravity.y).substr(1) + "," +
                                     setting("", s.gravity.z).substr(1) + "]",
                                 "groom.grid=[" + std::to_string(s.shapes.size()) + ",1]",
                                 "groom.particles=" + std::to_string(first.size())};
    if (!(fibre > 0))
        set.insert(set.end(),
                   {setting("groom.linear_density", linear_density), setting("stretch.stiffness", k),
                    setting("bend.stiffness", k), setting("core.stiffness", k)});
    set.insert(set.end(), s.set.begin(), s.set.end());
    Scene scene = scene_of(text + s.more, "battery", ".", set, method);
    for (int strand = 0; strand < scene.groom.rest.count; ++strand)
        for (int i = 0; i < scene.groom.rest.particles; ++i)
            scene.groom.rest.at(strand, i) = cast<float>(s.shapes[size_t(strand)][size_t(i)]);
    if (auto& core = scene.term<Core>()) core->beta = filter_beta(mean_segment(scene.groom), core->alpha_c);
    return scene;
}

Trial::Trial(const StabilityMethod& method, Scene scene) : method_(method) { go_on_in(std::move(scene)); }

void Trial::go_on_in(Scene scene) {
    auto next = std::make_unique<Scene>(std::move(scene));
    const std::string precision = trusted_precision(*next, method_.precision);
    promoted_ = promoted_ || precision != method_.precision;
    auto simulation = make_simulation(*next, precision);
    simulation->count_work();
    if (simulation_) {
        const double before = total();
        given += simulation_->work().given();
        SimulationState state = simulation_->state();
        state.first = true;  // of the steps before mass and step may have been others
        simulation->restore(state);
        simulation_ = std::move(simulation);
        given += total() - before;
    } else {
        simulation_ = std::move(simulation);
        start = most_energy = total();
    }
    scene_ = std::move(next);
    look();
}

void Trial::set(const SimulationState& state) {
    simulation_->restore(state);
    simulation_->count_work();
    start = most_energy = total();
    given = excess = scale = most_kinetic = 0;
    look();
}

double Trial::total() const {
    const auto e = simulation_->energy();
    return std::accumulate(e.begin(), e.end(), 0.0);
}

double Trial::weight_length() const {
    double sum = 0;
    const Strands& p = scene_->groom.rest;
    for (int s = 0; s < p.count; ++s) {
        const double length = arc_length(p.strand(s), p.particles);
        sum += scene_->linear_density * length * 9.81 * length;
    }
    return sum;
}

void Trial::look() {
    const auto kinds = simulation_->energy();
    const double e = std::accumulate(kinds.begin(), kinds.end(), 0.0);
    const double w = given + simulation_->work().given();
    kinetic = kinds[0];
    finite = finite && std::isfinite(e) && e < 1e12;
    if (!finite) return;
    most_kinetic = std::max(most_kinetic, kinetic);
    most_energy = std::max(most_energy, e);
    scale = std::max(scale, kinetic + std::abs(w));
    excess = std::max(excess, e - start - w);
}

void Trial::advance() {
    if (!finite) return;
    if (method_.advance)
        method_.advance(*simulation_, *scene_);
    else
        simulation_->advance();
    look();
}

void Trial::advance_for(double seconds) {
    const long frames = std::lround(seconds * scene_->fps);
    for (long f = 0; f < frames && finite; ++f) advance();
}

double Trial::energy_ratio() const {
    if (!finite) return std::numeric_limits<double>::infinity();
    // Below rounding of what the strands' weight stores nothing is said.
    const double floor = 1e-9 * weight_length();
    return excess <= floor ? 0 : excess / std::max(scale, floor);
}

void Trial::report(StabilityCase& result) const {
    result.finite = result.finite && finite;
    result.energy_ratio = energy_ratio();
    if (promoted_) result.measured.emplace_back("in_double", 1);
}

double jitter_of(Trial& trial) {
    std::vector<RunFrame> last(8);
    for (auto& frame : last) {
        trial.advance();
        trial.simulation().snapshot(frame);
    }
    double square = 0;
    size_t count = 0;
    for (size_t f = 0; f + 3 < last.size(); ++f)
        for (size_t k = 0; k < last[0].seen().points.size(); ++k, ++count) {
            auto p = [&](size_t j) { return cast<double>(last[f + j].seen().points[k]); };
            const Vec3d third = p(3) - 3.0 * p(2) + 3.0 * p(1) - p(0);
            square += dot(third, third);
        }
    return std::sqrt(square / double(count)) / mean_segment(trial.scene().groom);
}

double farthest(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double d = norm(a[i] - b[i]);
        most = d <= most ? most : d;  // NaN counts
    }
    return most;
}

void carry_frames(SimulationState& s, int n) {
    s.x_before = s.x;
    if (s.frame.empty()) return;
    for (size_t k = 0; k < s.x.size(); k += size_t(n))
        transport_frames(n, &s.frame[k], Quatd::identity(), &s.x[k], &s.frame[k]);
}

void add_noise(SimulationState& s, int n, double size, unsigned seed) {
    std::mt19937 random(seed);
    auto number = [&] { return size * (2.0 * random() / 4294967295.0 - 1); };
    for (size_t k = 0; k < s.x.size(); ++k)
        if (k % size_t(n) >= 2) s.x[k] += Vec3d{number(), number(), number()};
    carry_frames(s, n);
}

void sway(SimulationState& s, int n, double angle) {
    const auto from = s.x;
    for (size_t k = 0; k < s.x.size(); ++k) {
        const int i = int(k % size_t(n));
        if (i < 2) continue;
        const double share = double(i - 1) / double(n - 2);
        s.x[k] = s.x[k - 1] + rotate(rotation_about({0, 0, 1}, angle * share), from[k] - from[k - 1]);
    }
    carry_frames(s, n);
}

}  // namespace wetcurl
