// Runs, trainings and adhesion networks as charts.
#include "app/drawing/plot_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "app/files/results.h"
#include "solver/terms/adhesion.h"

namespace wetcurl {

namespace {

// Apart for the colour-blind: Okabe and Ito 2008, and three more.
constexpr Vec3f vermilion{0.84f, 0.37f, 0.00f}, blue{0.00f, 0.45f, 0.70f}, green{0.00f, 0.62f, 0.45f},
    pink{0.80f, 0.47f, 0.65f}, sky{0.34f, 0.71f, 0.91f}, amber{0.90f, 0.62f, 0.00f},
    violet{0.45f, 0.30f, 0.75f}, brown{0.55f, 0.36f, 0.24f}, grey{0.55f, 0.55f, 0.55f},
    black{0.10f, 0.10f, 0.10f};

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }

// A kind has the same colour whatever else a run has.
Curve energy_curve(const std::string& kind) {
    const std::vector<std::pair<std::string, Vec3f>> known{
        {"kinetic", vermilion}, {"gravity", blue}, {"stretch", green},  {"bend", pink},
        {"twist", sky},         {"core", amber},   {"baseline", violet}};
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.first == kind; });
    return {kind == "baseline" ? "wet forces" : kind, found == known.end() ? grey : found->second, {}};
}

double median_of(const std::vector<double>& values) {
    std::vector<double> finite;
    for (double v : values)
        if (std::isfinite(v)) finite.push_back(v);
    return time_statistics(finite)["median"];
}

std::string milliseconds(double ms) {
    return ms >= 99.95  ? fmt::format("{:.0f} ms", ms)
           : ms >= 0.01 ? fmt::format("{:.3g} ms", ms)
                        : fmt::format("{:.1g} ms", ms);
}

// The times of a run [ms]: not a number where a frame took none.
struct Times {
    std::vector<double> whole;                          // (frame)
    std::map<std::string, std::vector<double>> stages;  // (frame) of each
};

Times times_of(const RunReader& run) {
    const auto& names = run.header().stages;
    const double none = std::numeric_limits<double>::quiet_NaN();
    Times t;
    for (int f = 0; f < run.frames(); ++f) {
        const RunFrame frame = run.frame(f);
        const bool took = frame.seconds > 0;
        t.whole.push_back(took ? 1e3 * frame.seconds : none);
        for (size_t k = 0; k < names.size(); ++k) {
            auto& values = t.stages[names[k]];
            if (values.size() < t.whole.size()) values.resize(t.whole.size(), took ? 0 : none);
            if (took) values.back() += 1e3 * double(frame.stage_seconds[k]);  // a name may come twice
        }
    }
    if (std::none_of(t.whole.begin(), t.whole.end(), [](double v) { return std::isfinite(v); }))
        throw Error(run.path() + ": found " + std::to_string(run.frames()) +
                    " frames without run times; plot --time draws what simulate and infer write");
    // A stage that did nothing has the time of reading the clock, which would stretch the axis to nothing.
    const double least = 1e-4 * median_of(t.whole);
    std::erase_if(t.stages, [&](const auto& stage) {
        return std::none_of(stage.second.begin(), stage.second.end(), [&](double v) { return v > least; });
    });
    return t;
}

}  // namespace

Chart energy_chart(const RunReader& run) {
    const RunHeader& h = run.header();
    if (h.energy_kinds.empty() || run.frames() < 2)
        throw Error(run.path() + ": found " + std::to_string(run.frames()) + " frames with " +
                    std::to_string(h.energy_kinds.size()) +
                    " kinds of energy; plot draws a simulated run of two frames or more");
    Chart chart;
    chart.title = stem_of(run.path());
    chart.x_label = "time [s]", chart.y_label = "energy [mJ]", chart.dx = 1 / h.fps;
    for (const auto& kind : h.energy_kinds) chart.curves.push_back(energy_curve(kind));
    Curve total{"total", black, std::vector<double>(size_t(run.frames()), 0), 3};
    const auto first = run.frame(0).energy;
    for (int f = 0; f < run.frames(); ++f) {
        const auto energy = run.frame(f).energy;
        for (size_t k = 0; k < energy.size(); ++k) {
            const double from = h.energy_kinds[k] == "gravity" ? double(first[k]) : 0;
            chart.curves[k].values.push_back(1e3 * (double(energy[k]) - from));
            total.values[size_t(f)] += chart.curves[k].values.back();
        }
    }
    std::erase_if(chart.curves, [](const Curve& c) {
        return std::all_of(c.values.begin(), c.values.end(), [](double e) { return e == 0; });
    });
    chart.curves.push_back(total);
    return chart;
}

std::vector<Chart> time_charts(const std::vector<std::unique_ptr<RunReader>>& runs) {
    constexpr Vec3f colours[] = {vermilion, blue, green, pink, sky, amber, violet, brown};
    std::vector<Times> times;
    std::map<std::string, double> largest;  // median of a stage over the runs
    for (const auto& run : runs) {
        times.push_back(times_of(*run));
        for (const auto& [name, values] : times.back().stages)
            largest[name] = std::max(largest[name], median_of(values));
    }
    std::vector<std::string> apart;
    for (const auto& [name, median] : largest)
        if (median > 0) apart.push_back(name);
    std::stable_sort(apart.begin(), apart.end(),
                     [&](const auto& a, const auto& b) { return largest[a] > largest[b]; });
    if (apart.size() > std::size(colours)) apart.resize(std::size(colours));
    std::vector<Chart> charts;
    double low = 1e300, high = 0;
    for (size_t r = 0; r < runs.size(); ++r) {
        const Times& t = times[r];
        Chart& chart = charts.emplace_back();
        chart.title = fmt::format("{}: {} a frame (median)", stem_of(runs[r]->path()),
                                  milliseconds(median_of(t.whole)));
        chart.x_label = "frame", chart.y_label = "time of a frame [ms]", chart.own_legend = true;
        auto add = [&](const std::string& name, Vec3f color, const std::vector<double>& values, float width) {
            const double median = median_of(values);
            chart.curves.push_back({name + ", " + milliseconds(median), color, values, width});
            if (median > 0) low = std::min(low, median), high = std::max(high, median);
        };
        add("whole frame", black, t.whole, 3);
        for (size_t k = 0; k < apart.size(); ++k)
            if (const auto found = t.stages.find(apart[k]); found != t.stages.end())
                add(apart[k], colours[k], found->second, 2);
        std::vector<double> rest(t.whole.size(), 0);
        size_t others = 0;
        for (const auto& [name, values] : t.stages) {
            const bool any = std::any_of(values.begin(), values.end(), [](double v) { return v > 0; });
            if (!any || std::find(apart.begin(), apart.end(), name) != apart.end()) continue;
            ++others;
            for (size_t f = 0; f < rest.size(); ++f) rest[f] += values[f];
        }
        if (others > 0) add(fmt::format("{} other stages", others), grey, rest, 2);
    }
    for (Chart& chart : charts) chart.logarithmic = high > 10 * low;
    return charts;
}

Chart training_chart(const TrainingLog& log) {
    const std::map<std::string, std::pair<Vec3f, float>> styles{
        {"training", {blue, 2}}, {"held out", {vermilion, 3}}, {"no network", {grey, 2}}};
    Chart chart;
    chart.title = log.name;
    if (const double best = log.least("held out"); std::isfinite(best))
        chart.title += fmt::format(": held out {:.3g}{} at best", best, log.unit == "mm" ? " mm" : "");
    chart.x_label = "epoch", chart.y_label = log.label();
    chart.logarithmic = chart.own_axes = true;
    for (const auto& series : log.series) {
        const auto& [color, width] = styles.at(series.name);
        chart.curves.push_back(
            {series.name, color, series.value, width, series.epoch, series.name == "no network"});
    }
    return chart;
}

std::vector<Chart> adhesion_charts(const PairsReader& pairs, Network& network, const std::string& model) {
    if (pairs.codec() != Codec::adhesion)
        throw Error(pairs.path() + ": holds pairs of codec " + name_of(pairs.codec()) +
                    "; plot draws codec adhesion, `wetcurl render --image` the others");
    if (network.card().codec != "adhesion" || network.card().input_channels != adhesion_inputs)
        throw Error(fmt::format(
            "{}: found a model of codec {} with {} inputs, {} needs codec adhesion with {}", model,
            network.card().codec, network.card().input_channels, pairs.path(), adhesion_inputs));
    std::vector<AdhesionSample> samples;
    for (int run = 0; run < pairs.runs(); ++run) {
        const auto more = pairs.adhesion(run);
        samples.insert(samples.end(), more.begin(), more.end());
    }
    if (samples.empty()) throw Error(pairs.path() + ": found no samples in it, one or more are needed");
    std::vector<float> inputs;
    for (const auto& s : samples) inputs.insert(inputs.end(), s.input.begin(), s.input.end());
    auto answers_to = [&](const std::vector<float>& to) {
        std::vector<float> out(samples.size());
        network.run(to.data(), {long(samples.size()), adhesion_inputs, 1, 1}, out.data());
        return out;
    };
    const std::vector<float> answers = answers_to(inputs);

    constexpr int own = AdhesionChannels::first(0), distance = own + AdhesionChannels::distance,
                  before = own + AdhesionChannels::force;
    const std::string force = "F.n / (sigma m a_max)", of = stem_of(model);
    double squares = 0, by_persistence = 0;
    size_t touching = 0;
    Scatter free{"not in contact", grey, {}, {}}, held{"in contact", blue, {}, {}},
        over{"network, in contact", blue, {}, {}};
    constexpr int bins = 40;
    double sum[bins] = {}, farthest = 0;
    long count[bins] = {};
    for (size_t k = 0; k < samples.size(); ++k) {
        const AdhesionSample& s = samples[k];
        Scatter& to = s.contact ? held : free;
        to.x.push_back(s.target), to.y.push_back(answers[k]);
        if (!s.contact) continue;
        ++touching;
        const double miss = double(answers[k]) - double(s.target),
                     still = double(s.input[before]) - double(s.target);
        squares += miss * miss, by_persistence += still * still;
        over.x.push_back(s.input[distance]), over.y.push_back(answers[k]);
        farthest = std::max(farthest, double(s.input[distance]));
    }
    farthest = std::max(1.0, farthest);
    for (size_t k = 0; k < over.x.size(); ++k) {
        const int bin = std::clamp(int(over.x[k] / farthest * bins), 0, bins - 1);
        sum[bin] += over.y[k], ++count[bin];
    }

    Chart scatter;
    scatter.title = fmt::format("{}: error {:.2g} in contact (force before: {:.2g})", of,
                                std::sqrt(squares / double(std::max<size_t>(touching, 1))),
                                std::sqrt(by_persistence / double(std::max<size_t>(touching, 1))));
    scatter.x_label = "target " + force + " [1]", scatter.y_label = "predicted " + force + " [1]";
    scatter.own_axes = scatter.own_legend = true;
    scatter.scatters = {free, held};
    double low = 0, high = 0;
    for (const auto& s : scatter.scatters)
        for (double v : s.x) low = std::min(low, v), high = std::max(high, v);
    scatter.curves.push_back({"as the target", black, {low, high}, 1.5f, {low, high}, true});

    Chart profile;
    profile.title =
        fmt::format("{}: {} samples in contact of {}", stem_of(pairs.path()), touching, samples.size());
    profile.x_label = "distance from the solid, phi / h [1]", profile.y_label = force + " [1]";
    profile.own_axes = profile.own_legend = true;
    profile.scatters = {over};
    Curve eq11{"Eq 11", black, {}, 2, {}, true}, mean{"network, mean", amber, {}, 2.5f, {}};
    for (int k = 0; k <= 200; ++k) {
        const double q = farthest * k / 200;
        double value, slope;
        Adhesion::shape(q, value, slope);
        eq11.x.push_back(q), eq11.values.push_back(-value);
    }
    for (int k = 0; k < bins; ++k)
        if (count[k] > 0)
            mean.x.push_back((k + 0.5) * farthest / bins), mean.values.push_back(sum[k] / double(count[k]));
    profile.curves = {mean, eq11};

    Chart worth;
    worth.title = "what each input is worth to " + of;
    worth.x_label = "root mean square change of F.n without it [sigma m a_max]";
    constexpr int each = AdhesionChannels::of_particle;
    const char* what[each] = {"contact", "v.n / sqrt(a_max h)", "phi / h", "F.n before"};
    const char* whose[AdhesionChannels::particles] = {"i-1", "i", "i+1"};
    for (int k = 0; k < adhesion_inputs; ++k) {
        double mean_of = 0, moved = 0;
        for (size_t s = 0; s < samples.size(); ++s)
            if (samples[s].contact) mean_of += double(samples[s].input[size_t(k)]) / double(touching);
        std::vector<float> without = inputs;
        for (size_t s = 0; s < samples.size(); ++s) without[s * adhesion_inputs + size_t(k)] = float(mean_of);
        const auto changed = answers_to(without);
        for (size_t s = 0; s < samples.size(); ++s)
            if (samples[s].contact) moved += std::pow(double(changed[s]) - double(answers[s]), 2);
        worth.bars.push_back({fmt::format("{} of {}", what[k % each], whose[k / each]),
                              std::sqrt(moved / double(std::max<size_t>(touching, 1))),
                              k / each == own / each ? blue : sky});
    }
    return {scatter, profile, worth};
}

}  // namespace wetcurl
