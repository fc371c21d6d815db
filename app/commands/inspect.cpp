// `wetcurl inspect`: what a file holds, and what a scene names and leaves out.
#include "app/commands/inspect.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/dataset/dataset_recipe.h"
#include "app/engine/device.h"
#include "app/engine/run_of_scene.h"
#include "app/engine/run_solids.h"
#include "app/files/key_rows.h"
#include "app/files/results.h"
#include "app/files/run_file.h"
#include "app/files/watch_results.h"
#include "app/measures/axial_extent.h"
#include "app/measures/fall.h"
#include "app/measures/locks.h"
#include "app/measures/settings_advice.h"
#include "app/options/option_list.h"
#include "base/log.h"
#include "base/provenance.h"
#include "learn/codec/core_detail.h"
#include "learn/codec/input_ranges.h"
#include "learn/codec/network_module.h"
#include "learn/codec/pairs.h"
#include "solver/chain/scene_checks.h"
#include "solver/run/simulation.h"
#include "solver/scene/findings.h"
#include "solver/scene/scene_rows.h"
#include "training/recipe.h"

namespace wetcurl {

namespace {

// Results go to one place: JSON where it is asked for, text otherwise.
void show(const InspectOptions& o, const Json& json, const std::string& text) {
    if (!o.json.empty()) return ResultFile(o).write_json(json);
    std::fputs(text.c_str(), stdout);
}
// A line for each key, or for each row of a table.
std::string lines_of(const Json& json) {
    std::string text;
    for (const auto& [key, value] : json.items()) {
        if (value.is_array() && !value.empty() && value[0].is_object()) {
            text += key + ":\n";
            for (const auto& row : value) {
                std::string line;
                for (const auto& [k, v] : row.items())
                    line += fmt::format("  {} {}", k, v.is_string() ? v.get<std::string>() : json_text(v));
                text += "  " + line + "\n";
            }
        } else if (value.is_array()) {
            std::vector<std::string> words;
            for (const auto& v : value) words.push_back(v.is_string() ? v.get<std::string>() : json_text(v));
            text += fmt::format("{}: {}\n", key, fmt::join(words, ", "));
        } else {
            text +=
                fmt::format("{}: {}\n", key, value.is_string() ? value.get<std::string>() : json_text(value));
        }
    }
    return text;
}
void show(const InspectOptions& o, const Json& json) { show(o, json, lines_of(json)); }

// To three digits, of what is an estimate.
double rounded(double value) { return std::stod(fmt::format("{:.3g}", value)); }

void show_scene(const InspectOptions& o) {
    const Scene scene = load_scene(o.file, {.set = o.set,
                                            .frames = {},
                                            .strands = {},
                                            .guides = 0,
                                            .seed = o.seed,
                                            .groom = "",
                                            .stride = 0,
                                            .findings_stop = false});
    check_files(o, "", scene.files);
    Scene at_rest = scene;  // nothing is computed before frame 0
    at_rest.integrator.settle = at_rest.preroll = 0;
    const auto simulation = make_simulation(at_rest, "float");
    const Presence p = presence_of(scene);
    Json json{{"title", scene.title},
              {"strands", scene.groom.rest.count},
              {"particles_per_strand", scene.groom.rest.particles},
              {"present", p.present},
              {"absent", p.absent},
              {"buffers", Json::array()},
              {"stages", simulation->stages}};
    size_t sum = 0;
    for (const auto& b : simulation->buffers()) {
        json["buffers"].push_back({{"name", b.name}, {"bytes", b.bytes}});
        sum += b.bytes;
    }
    json["bytes"] = sum;
    json["bytes_per_particle"] = double(sum) / double(scene.groom.rest.points.size());
    json["stiffness_number"] = stiffness_number(scene);
    json["curl_turns"] = rounded(scene.curl_turns.turns);
    json["curl_radius_mm"] = rounded(1000 * scene.curl_turns.radius);
    if (const auto advice = advice_on(scene)) {
        json["measured_on"] = {
            {"hair", advice->hair}, {"kind", advice->kind}, {"processor", advice->machine}};
        for (const auto& row : advice->rows)
            json["settings"].push_back({{"setting", row.setting},
                                        {"error_percent", rounded(row.error)},
                                        {"time", rounded(row.time)}});
        json["advice"] = advice->advice;
    }
    std::string text = lines_of(json);
    json["findings"] = Json::array();
    for (const Finding& finding : findings_of(scene)) {
        json["findings"].push_back(json_of(finding));
        text += fmt::format("{}: {}\n", name_of(finding.level), described(finding));
    }
    show(o, json, text);
}

// [s] of each frame but frame 0, a state that nothing was computed for.
std::vector<double> run_times_of(const RunReader& run) {
    auto seconds = run.seconds();
    if (!seconds.empty()) seconds.erase(seconds.begin());
    return seconds;
}

// A hash of what is added so far, in this order: equal runs, and equal weights, have equal ones.
class Hash {
  public:
    template <class T>
    void add(const std::vector<T>& values) {
        const std::string next = so_far_ + hash_bytes(values.data(), values.size() * sizeof(T));
        so_far_ = hash_bytes(next.data(), next.size());
    }
    const std::string& text() const { return so_far_; }

  private:
    std::string so_far_;
};

double mean_of(const std::vector<float>& values) {
    return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

// Of particles that have come from `before` to `now` in so long [s]: [mm/s].
Json speeds_json(const Strands& before, const Strands& now, double seconds) {
    std::vector<double> speed(now.points.size());
    for (size_t k = 0; k < speed.size(); ++k)
        speed[k] = 1000 * double(norm(now.points[k] - before.points[k])) / seconds;
    std::sort(speed.begin(), speed.end());
    return {{"mean", std::accumulate(speed.begin(), speed.end(), 0.0) / double(speed.size())},
            {"p99", speed[(speed.size() - 1) * 99 / 100]},
            {"max", speed.back()}};
}

Json run_json(const InspectOptions& o) {
    const RunReader run(o.file);
    const RunHeader& h = run.header();
    Json json{{"method", h.method},
              {"frames", run.frames()},
              {"fps", h.fps},
              {"strands", h.groom.rest.count},
              {"particles_per_strand", h.groom.rest.particles},
              {"grid", {h.groom.grid.width, h.groom.grid.height}},
              {"stride", h.stride},
              {"guides", h.guides},
              {"substeps", substeps_of(h)},
              {"seed", h.seed},
              {"device", h.device},
              {"wetness_recorded", !h.saturation.empty()},
              {"terms_present", h.terms_present},
              {"terms_absent", h.terms_absent},
              {"seconds_per_frame", time_statistics(run_times_of(run))}};
    if (run.frames() > 0) {
        const auto solid = solid_distance_of(h, true);
        double extent = 0;
        Bounce bounce;
        Strands before;
        FrameWatch watch(h.groom, h.fps);
        Hash hash;                                              // of displayed particles, frame by frame
        std::vector<double> stage_seconds(h.stages.size(), 0);  // summed over frames but frame 0
        for (int f = 0; f < run.frames(); ++f) {
            const RunFrame frame = run.frame(f);
            for (size_t k = 0; k < h.stages.size() && f > 0; ++k)
                stage_seconds[k] += double(frame.stage_seconds[k]);
            hash.add(frame.seen().points);
            watch.look(f, frame);
            const double extent_now = 1000 * axial_extent(frame.seen());
            extent += extent_now / run.frames();
            const Fall fall = fall_of(frame.seen(), solid, frame.head, h.time(f));
            if (solid) {
                std::vector<float> distance;
                for (const Vec3f& x : frame.seen().points)
                    distance.push_back(solid(x, frame.head, h.time(f)));
                bounce.add(std::move(distance));
            }
            json["fall"].push_back({{"time", h.time(f)},
                                    {"width_mm", 1000 * fall.width},
                                    {"height_mm", 1000 * fall.height},
                                    {"drop_mm", 1000 * fall.drop},
                                    {"axial_extent_mm", extent_now},
                                    {"curl_radius_mm", 1000 * mean_of(curl_radii(frame.seen()))},
                                    {"angle_degrees", fall.angle ? Json(*fall.angle) : Json(nullptr)}});
            if (f > 0)
                json["fall"].back()["speed_mm_per_s"] =
                    speeds_json(before, frame.seen(), h.time(f) - h.time(f - 1));
            before = frame.seen();
        }
        json["hash"] = hash.text();
        json["extremes"] = json_of(watch);
        if (const std::string warning = warning_of(watch); !warning.empty())
            log_warning(o.file + ": " + warning);
        json["axial_extent_mm"] = extent;
        if (const auto value = bounce.value()) json["bounce_mm"] = 1000 * *value;
        // (frame) [J] of each kind, and their sum: what VI.I plots.
        for (int f = 0; f < run.frames() && !h.energy_kinds.empty(); ++f) {
            const auto energy = run.frame(f).energy;
            Json row{{"time", h.time(f)}};
            double sum = 0;
            for (size_t k = 0; k < h.energy_kinds.size(); ++k)
                row[h.energy_kinds[k]] = energy[k], sum += energy[k];
            row["sum"] = sum;
            json["energy_joule"].push_back(row);
        }
        const RunFrame last = run.frame(run.frames() - 1);
        json["displayed"] = last.displayed.count > 0;
        if (last.displayed.count > 0 && last.positions.count > 0) {
            const Locks locks = locks_of(last.positions, last.displayed, support_radius_of(h) / 2);
            json["locks"] = {{"gathered_mm", 1000 * locks.gathered},
                             {"drawn_mm", 1000 * locks.drawn},
                             {"tips_mm", 1000 * locks.tips},
                             {"strands", locks.strands},
                             {"share_of_strands", locks.share}};
        }
        for (size_t k = 0; k < h.energy_kinds.size(); ++k)
            json["last_energy_joule"][h.energy_kinds[k]] = last.energy[k];
        const char* water[] = {"held", "taken", "dripped", "dried"};
        for (size_t k = 0; k < last.water.size(); ++k) json["last_water_kg"][water[k]] = last.water[k];
        for (size_t k = 0; k < h.stages.size(); ++k)
            json["last_stage_seconds"][h.stages[k]] = last.stage_seconds[k];
        for (size_t k = 0; k < h.stages.size() && run.frames() > 1; ++k)
            json["mean_stage_seconds"][h.stages[k]] = stage_seconds[k] / (run.frames() - 1);
    }
    return json;
}

Json pairs_json(const InspectOptions& o) {
    const H5Reader file(o.file, pairs_format, pairs_version);
    Json json{{"codec", file.text("codec")},
              {"particles_per_strand", file.number("particles")},
              {"runs", Json::array()}};
    for (const auto& run : file.list("runs")) {
        Json one{{"name", run}};
        for (const auto& name : file.list("runs/" + run)) one[name] = file.shape("runs/" + run + "/" + name);
        json["runs"].push_back(one);
    }
    return json;
}

Json model_json(const InspectOptions& o) {
    const ModelCard card = network_module().card(o.file);
    const H5Reader file(o.file, model_format, model_version);
    Json weights = Json::array();  // of each layer, by name
    Hash hash;
    for (const auto& name : file.list("weights")) {
        weights.push_back({{"name", name}, {"shape", file.shape("weights/" + name)}});
        hash.add(file.read<float>("weights/" + name));
    }
    Json ranges = Json::object();
    for (const InputRange& range : input_ranges(card))
        ranges[range.name] = range.low <= -everything ? Json() : Json{range.low, range.high};
    return {{"codec", card.codec},
            {"architecture", card.architecture},
            {"width", card.width},
            {"parameters", card.parameters},
            {"inputs", card.input_channels},
            {"outputs", card.output_channels},
            {"upscale", card.upscale},
            {"target", card.codec == "strand" ? Json(card.target) : Json()},
            {"low", card.low},
            {"low_substeps", card.low_substeps ? Json(card.low_substeps) : Json()},
            {"numbers", card.numbers},
            {"input_ranges", ranges.empty() ? Json() : ranges},
            {"trained_on", card.inputs},
            {"recipe", card.recipe},
            {"hash", hash.text()},
            {"weights", weights}};
}

Json device_json() {
    Json json{{"processors", omp_get_num_procs()},
              {"lanes_float", lanes_of<float>},
              {"lanes_double", lanes_of<double>},
              {"cuda_devices", names_of_cuda_devices()}};
    for (const auto& [name, text] : provenance())
        if (name != "gpu") json[name] = text;
    return json;
}

// Of a scene, of a data set's recipe, or of a training's, which has other defaults for each codec.
void show_keys(const InspectOptions& o) {
    if (o.file.empty() || o.file == "scene") return show(o, json_of(scene_rows()), text_of(scene_rows()));
    if (o.file == "dataset") return show(o, json_of(dataset_rows()), text_of(dataset_rows()));
    if (o.file != "train")
        throw Misuse("inspect keys: found '" + o.file + "', allowed: scene, dataset, train" +
                     did_you_mean(o.file, {"scene", "dataset", "train"}));
    Json json;
    std::string text;
    for (const auto& [name, codec] : {std::pair{"strand", Codec::strand}, std::pair{"root", Codec::root},
                                      std::pair{"adhesion", Codec::adhesion}}) {
        const auto tables = recipe_tables(codec);
        json[name] = json_of(tables);
        text += fmt::format("{}# codec {}\n\n{}", text.empty() ? "" : "\n", name, text_of(tables));
    }
    show(o, json, text);
}

// Kinds of hair that [fibre] names, with what follows from their numbers, dry and drenched.
void show_hair(const InspectOptions& o) {
    Json kinds = Json::array();
    std::string text = fmt::format("{:8} {:>5} {:>6} {:>8} {:>8} {:>8} {:>8}  {}\n", "hair", "um", "a / b",
                                   "EI nNm2", "GJ nNm2", "curl mm", "turn mm", "what it is; fibre; curl");
    for (const HairKind& kind : hair_kinds) {
        Fibre fibre;
        fibre.diameter = kind.diameter, fibre.ellipticity = kind.ellipticity;
        fibre.youngs_modulus = kind.youngs_modulus, fibre.shear_modulus = kind.shear_modulus;
        const WetSprings::Factors wet = fibre.wet_springs().at(1);
        const double ei = fibre.flexural_rigidity(), gj = fibre.torsional_rigidity();
        kinds.push_back({{"hair", kind.name},
                         {"about", kind.about},
                         {"diameter", kind.diameter},
                         {"ellipticity", kind.ellipticity},
                         {"youngs_modulus", kind.youngs_modulus},
                         {"shear_modulus", kind.shear_modulus},
                         {"curl_radius", kind.curl_radius},
                         {"pitch", kind.pitch},
                         {"source_of_fibre", kind.of_fibre},
                         {"source_of_curl", kind.of_curl},
                         {"linear_density", fibre.linear_density()},
                         {"flexural_rigidity", ei},
                         {"torsional_rigidity", gj},
                         {"wet_flexural_rigidity", wet.bend * ei},
                         {"wet_torsional_rigidity", wet.twist * gj}});
        const auto of_curl = [&](const char* digits, double value) {
            return kind.curl_radius > 0 ? fmt::format(fmt::runtime(digits), 1e3 * value) : "-";
        };
        text += fmt::format("{:8} {:5.0f} {:6.2f} {:8.2f} {:8.2f} {:>8} {:>8}  {}; {}; {}\n", kind.name,
                            1e6 * kind.diameter, kind.ellipticity, 1e9 * ei, 1e9 * gj,
                            of_curl("{:.1f}", kind.curl_radius), of_curl("{:.0f}", kind.pitch), kind.about,
                            kind.of_fibre, kind.of_curl);
    }
    show(o, {{"kinds", kinds}}, text);
}

}  // namespace

void add_options(OptionList& options, InspectOptions& o) {
    options
        .option(
            "what", o.what,
            "scene | run | pairs | model: a file of that kind; keys: every key of a scene, or of a recipe; "
            "schema: those of a scene as a JSON schema, for editors; hair: kinds of hair that [fibre] names; "
            "device: this machine")
        .required()
        .one_of({"scene", "run", "pairs", "model", "keys", "schema", "hair", "device"});
    options.option("file", o.file, "the file; with keys: scene (default) | dataset | train").input_file();
    options.option("-o,--output", o.output, "").hidden();  // once images of pairs: said in the error
    options.footer("`wetcurl render --image PAIRS.h5 -o out.png` draws the geometry images of pairs.");
}

int inspect_command(const InspectOptions& given) {
    InspectOptions o = given;
    if (o.what == "run") o.file = run_to_read(o.file);
    if (!o.output.empty())
        throw Misuse(
            "inspect: -o " + o.output +
            ": it writes no pictures; `wetcurl render --image PAIRS.h5 -o out.png` draws the geometry "
            "images of pairs, --json FILE writes what inspect says");
    const bool needs_file = o.what != "keys" && o.what != "schema" && o.what != "hair" && o.what != "device";
    if (needs_file && o.file.empty()) throw Misuse("inspect " + o.what + " needs a file");
    if (!needs_file && o.what != "keys" && !o.file.empty())
        throw Misuse("inspect " + o.what + ": found the file " + o.file + ", none is needed");
    if (o.what != "scene") refuse_scene_options(o, "inspect " + o.what);
    check_files(o, "", {needs_file ? o.file : ""});
    if (o.what == "scene") show_scene(o);
    if (o.what == "run") show(o, run_json(o));
    if (o.what == "pairs") show(o, pairs_json(o));
    if (o.what == "model") show(o, model_json(o));
    if (o.what == "keys") show_keys(o);
    if (o.what == "schema") {
        const Json schema = schema_of(scene_rows(), "A scene of wetcurl");
        show(o, schema, json_text(schema, 2) + "\n");
    }
    if (o.what == "hair") show_hair(o);
    if (o.what == "device") show(o, device_json());
    return 0;
}

}  // namespace wetcurl
