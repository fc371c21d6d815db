// The run cache on HDF5.
#include "base/run_cache.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

namespace wetcurl {

namespace {

std::string lines(const std::vector<std::string>& v) {
    std::string s;
    for (const auto& e : v) s += e + "\n";
    return s;
}
std::vector<std::string> split_lines(const std::string& s) {
    std::vector<std::string> out;
    std::stringstream in(s);
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
}
constexpr size_t water_columns = 4;  // of RunFrame::water
constexpr const char* last_dataset = "seconds";
// Of frames, beside those that every run has.
constexpr const char* datasets_of_frames[] = {"positions",     "displayed", "energy",
                                              "stage_seconds", "contact",   "living_saturation",
                                              "water",         "head",      last_dataset};

// How many frames of a run that is not whole are there in all of its datasets. Throws Error where it was cut:
// the nodes that lead to frames are written anew behind the last one, so that without its end nothing leads
// to any.
size_t whole_frames(const H5Reader& f) {
    if (!f.has(last_dataset)) return 0;
    const auto shape = f.shape(last_dataset);
    const size_t said = shape.empty() ? 0 : shape[0];
    size_t frames = said;
    for (const char* name : datasets_of_frames)
        if (f.has(name)) frames = f.rows_there(name, frames);
    if (frames == 0 && said > 1 && f.written() == H5Reader::Written::broken_off)
        throw Error(
            f.path() + ": found a run of " + std::to_string(said) +
            " frames whose end is missing, and with it what leads to each of them: it was cut after it was "
            "written, as by a copy that did not end; copy it again, or make it again");
    return frames;
}

// Throws Error, naming dataset and place, for the first value outside [low, high]. `columns`: values a frame,
// 0: the dataset has none.
template <class T>
void check_within(const std::vector<T>& values, const H5Reader& f, const std::string& dataset, double low,
                  double high, size_t columns) {
    for (size_t k = 0; k < values.size(); ++k) {
        if (values[k] >= low && values[k] <= high) continue;
        std::ostringstream text;
        text << f.path() << ": dataset '" << dataset << "', ";
        columns ? text << "frame " << k / columns : text << "value " << k;
        text << ": found " << values[k] << ", allowed ";
        std::isfinite(high) ? text << low << " to " << high : text << low << " or more";
        throw Error(text.str() + " (the file is damaged, or another program wrote it)");
    }
}

size_t cells(const Strands& s) { return size_t(s.count) * size_t(s.particles); }
const float* floats(const Strands& s) { return &s.points.data()->x; }

}  // namespace

std::string kind_of(const RunHeader& header) {
    if (header.method.starts_with("simulated"))
        return header.method.ends_with("learned") ? "learned" : "simulated";
    // What is inferred names its dry run and, where there is one, the model.
    const bool no_network = header.method.starts_with("strand_linear") || header.method.starts_with("oracle");
    return header.inputs.size() < 2 || no_network ? "interpolated" : "learned";
}

std::string scene_name(const RunHeader& header) {
    return header.path.empty() ? "the run's scene" : header.path + ": its scene";
}

struct RunWriter::Body {
    H5Writer file;
    size_t strands, particles, energies, stages;
    size_t frames = 0;       // appended
    bool is_shared = false;  // once its datasets are there

    // Calls put(name, values of a row, their shape) for each dataset of frames, the one of `seconds` last: a
    // frame is whole once it has its row there.
    template <class Put>
    void for_each_row(const RunFrame& frame, Put put) const {
        const size_t s = strands, n = particles;
        put("positions", floats(frame.positions), {s, n, 3});
        if (frame.displayed.count) put("displayed", floats(frame.displayed), {s, n, 3});
        if (energies) put("energy", frame.energy.data(), {energies});
        if (stages) put("stage_seconds", frame.stage_seconds.data(), {stages});
        if (!frame.contact.empty()) put("contact", frame.contact.data(), {s, n});
        if (!frame.saturation.empty()) put("living_saturation", frame.saturation.data(), {s, n});
        if (!frame.expected_error.empty())
            put("expected_error", frame.expected_error.data(), {s, frame.expected_error.size() / s});
        if (!frame.water.empty()) put("water", frame.water.data(), {water_columns});
        const double head[7] = {frame.head.translation.x, frame.head.translation.y, frame.head.translation.z,
                                frame.head.rotation.w,    frame.head.rotation.x,    frame.head.rotation.y,
                                frame.head.rotation.z};
        put("head", head, {7});
        put(last_dataset, &frame.seconds, {1});
    }
};

// A member of each strand's origin as a dataset, and back.
template <class T>
static void write_member(H5Writer& f, const std::string& name, const std::vector<StrandOrigin>& origin,
                         T StrandOrigin::*member) {
    std::vector<T> values;
    for (const auto& strand : origin) values.push_back(strand.*member);
    f.write(name, values.data(), {values.size()});
}
template <class T>
static void read_member(const H5Reader& f, const std::string& name, std::vector<StrandOrigin>& origin,
                        T StrandOrigin::*member) {
    const auto values = f.read<T>(name, {origin.size()});
    for (size_t s = 0; s < origin.size(); ++s) origin[s].*member = values[s];
}

static void write_origin(H5Writer& f, const Groom& groom) {
    const std::vector<StrandOrigin> origin = origins_of(groom);
    write_member(f, "groom/number", origin, &StrandOrigin::number);
    write_member(f, "groom/id", origin, &StrandOrigin::id);
    write_member(f, "groom/group", origin, &StrandOrigin::group);
    std::vector<float> uv;
    for (const auto& strand : origin) uv.insert(uv.end(), strand.uv, strand.uv + 2);
    f.write("groom/root_uv", uv.data(), {origin.size(), 2});
    if (!groom.width.empty())
        f.write("groom/width", groom.width.data(), {origin.size(), size_t(groom.rest.particles)});
}
static std::vector<StrandOrigin> read_origin(const H5Reader& f, size_t strands) {
    std::vector<StrandOrigin> origin(strands);
    read_member(f, "groom/number", origin, &StrandOrigin::number);
    read_member(f, "groom/id", origin, &StrandOrigin::id);
    read_member(f, "groom/group", origin, &StrandOrigin::group);
    const auto uv = f.read<float>("groom/root_uv", {strands, 2});
    for (size_t s = 0; s < strands; ++s) std::copy_n(&uv[2 * s], 2, origin[s].uv);
    return origin;
}

static std::vector<float> read_width(const H5Reader& f, size_t strands, size_t particles) {
    if (!f.has("groom/width")) return {};
    if (f.shape("groom/width").size() > 1) return f.read<float>("groom/width", {strands, particles});
    // Of a run of before: one a strand, 0 where the file says none.
    std::vector<float> out;
    for (const float width : f.read<float>("groom/width", {strands})) out.insert(out.end(), particles, width);
    if (std::all_of(out.begin(), out.end(), [](float width) { return width == 0; })) out.clear();
    return out;
}

RunWriter::RunWriter(OutputFile place, const RunHeader& h)
    : body_(new Body{{std::move(place), run_format, run_version, H5Writer::Layout::shared},
                     size_t(h.groom.rest.count),
                     size_t(h.groom.rest.particles),
                     h.energy_kinds.size(),
                     h.stages.size()}) {
    H5Writer& f = body_->file;
    f.attribute("scene", h.scene);
    f.attribute("scene_folder", h.scene_folder);
    f.attribute("method", h.method);
    f.attribute("device", h.device);
    f.attribute("fps", h.fps);
    if (h.start != 0) f.attribute("start", h.start);
    f.attribute("seed", std::to_string(h.seed));
    f.attribute("stride", double(h.stride));
    if (h.guides > 0) f.attribute("guides", double(h.guides));
    f.attribute("energy_kinds", lines(h.energy_kinds));
    f.attribute("stages", lines(h.stages));
    f.attribute("inputs", lines(h.inputs));
    f.attribute("terms_present", h.terms_present);
    f.attribute("terms_absent", h.terms_absent);
    f.attribute("groom_hash", h.groom.hash());
    f.write("groom/points", floats(h.groom.rest), {body_->strands, body_->particles, 3});
    f.write("groom/normal", &h.groom.normal.data()->x, {body_->strands, 3});
    const std::vector<int32_t> grid(h.groom.grid.strand.begin(), h.groom.grid.strand.end());
    f.write("groom/grid", grid.data(), {size_t(h.groom.grid.height), size_t(h.groom.grid.width)});
    if (h.followed) f.write("groom/followed", std::vector<int32_t>(h.followed->begin(), h.followed->end()));
    write_origin(f, h.groom);
    if (!h.saturation.empty()) f.write("saturation", h.saturation.data(), {body_->strands, body_->particles});
}

RunWriter::RunWriter(OutputFile place, const RunHeader& h, int frames)
    : body_(new Body{H5Writer(std::move(place)), size_t(h.groom.rest.count), size_t(h.groom.rest.particles),
                     h.energy_kinds.size(), h.stages.size(), size_t(frames), true}) {}

RunWriter::~RunWriter() = default;

void RunWriter::append(const RunFrame& frame) {
    H5Writer& f = body_->file;
    if (cells(frame.positions) != body_->strands * body_->particles)
        throw Error(f.path() + ": a frame of another number of particles than the groom's");
    if (!std::exchange(body_->is_shared, true)) {
        body_->for_each_row(frame, [&]<class T>(const char* name, const T*, std::vector<size_t> shape) {
            f.make_rows<T>(name, shape);
        });
        f.share();
    }
    body_->for_each_row(frame, [&](const char* name, const auto* row, std::vector<size_t> shape) {
        if (std::string_view(name) == last_dataset) f.flush();
        f.put_row(name, body_->frames, row, shape);
    });
    f.flush();
    ++body_->frames;
}
void RunWriter::commit() { body_->file.commit(); }

struct RunReader::Body {
    H5Reader file;
    RunHeader header;
    int frames = 0;
    std::vector<double> head, seconds;
};

RunReader::RunReader(const std::string& named, bool mine)
    : body_(new Body{{named, run_format, run_version, 1, mine}, {}, 0, {}, {}}) {
    const H5Reader& f = body_->file;
    const std::string path = f.path();
    const bool is_partial = path.ends_with(".partial");
    RunHeader& h = body_->header;
    h.path = path;
    h.scene = f.text("scene");
    h.scene_folder = f.text("scene_folder");
    h.method = f.text("method");
    h.device = f.text("device");
    h.fps = f.number("fps");
    if (f.has_attribute("start")) h.start = f.number("start");
    const std::string seed = f.text("seed");
    const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), h.seed);
    if (error != std::errc() || end != seed.data() + seed.size())
        throw Error(path + ": attribute 'seed': found '" + seed + "', a whole number of 64 bits is needed");
    h.stride = f.integer("stride", 1, 1 << 20);
    if (f.has_attribute("guides")) h.guides = f.integer("guides", 1, 1 << 30);
    h.energy_kinds = split_lines(f.text("energy_kinds"));
    h.stages = split_lines(f.text("stages"));
    h.inputs = split_lines(f.text("inputs"));
    h.terms_present = f.text("terms_present");
    h.terms_absent = f.text("terms_absent");
    if (f.has_attribute("provenance.revision"))
        h.build = "wetcurl " + f.text("provenance.version") + ", revision " + f.text("provenance.revision") +
                  ", " + f.text("provenance.compiler");
    else if (f.has_attribute("build"))  // of a version before
        h.build = f.text("build");
    if (!(h.fps > 0)) throw Error(path + ": fps must be positive");
    const auto points = f.shape("groom/points");
    if (points.size() != 3 || points[0] == 0 || points[1] < 2 || points[2] != 3 || points[0] > 100'000'000 ||
        points[1] > 100'000)
        throw Error(path + ": dataset 'groom/points' must be (strands ≥ 1, particles ≥ 2, 3)");
    const auto rest = f.read<float>("groom/points");
    h.groom.rest = Strands(int(points[0]), int(points[1]));
    std::copy(rest.begin(), rest.end(), &h.groom.rest.points.data()->x);
    const auto normal = f.read<float>("groom/normal", {points[0], 3});
    h.groom.normal.resize(points[0]);
    std::copy(normal.begin(), normal.end(), &h.groom.normal.data()->x);
    const auto grid_shape = f.shape("groom/grid");
    const auto grid = f.read<int32_t>("groom/grid", {0, 0});
    h.groom.grid = {int(grid_shape[1]), int(grid_shape[0]), {grid.begin(), grid.end()}};
    std::vector<char> seen(points[0], 0);
    for (int s : h.groom.grid.strand)
        if (s < -1 || s >= int(points[0]) || (s >= 0 && seen[size_t(s)]++))
            throw Error(path + ": dataset 'groom/grid' names strand " + std::to_string(s) +
                        " twice or out of range");
    if (f.has("groom/followed")) {
        const auto followed = f.read<int32_t>("groom/followed", {0});
        h.followed.emplace(followed.begin(), followed.end());
        for (int s : *h.followed)
            if (s < 0 || s >= int(points[0]))
                throw Error(path + ": dataset 'groom/followed' names strand " + std::to_string(s) +
                            ", allowed are 0 to " + std::to_string(points[0] - 1));
    }
    if (f.has("groom/number")) h.groom.origin = read_origin(f, points[0]);
    h.groom.width = read_width(f, points[0], points[1]);
    if (f.has("saturation")) {
        h.saturation = f.read<float>("saturation", {points[0], points[1]});
        check_within(h.saturation, f, "saturation", 0, 1, 0);
    }
    if (f.has("positions")) {
        const auto shape = f.shape("positions");
        if (shape.size() != 4 || shape[1] != points[0] || shape[2] != points[1] || shape[3] != 3)
            throw Error(path +
                        ": dataset 'positions' must be (frames, strands, particles, 3) of the groom's size");
        const size_t n = is_partial ? whole_frames(f) : shape[0];
        body_->frames = int(n);
        // A whole file has no more rows.
        const auto rows = [&]<class T>(const char* name, std::vector<size_t> row, T) {
            auto found = f.shape(name);
            if (!is_partial && !found.empty() && found[0] != n)
                throw Error(path + ": dataset '" + name + "' must have a row for each of " +
                            std::to_string(n) + " frames");
            return f.read_rows<T>(name, n, row);
        };
        body_->head = rows("head", {7}, double());
        body_->seconds = rows("seconds", {1}, double());
        check_within(body_->seconds, f, "seconds", 0, INFINITY, 1);
        const auto same_cells = [&](const char* name, std::vector<size_t> row, const char* needed) {
            if (!f.has(name)) return;
            const auto found = f.shape(name);
            if (found.size() != row.size() + 1 || !std::equal(row.begin(), row.end(), found.begin() + 1) ||
                found[0] < n || (!is_partial && found[0] != n))
                throw Error(path + ": dataset '" + name + "' must " + needed);
        };
        same_cells("displayed", {points[0], points[1], 3}, "have the shape of 'positions'");
        same_cells("contact", {points[0], points[1]}, "be (frames, strands, particles)");
        same_cells("living_saturation", {points[0], points[1]}, "be (frames, strands, particles)");
        if (f.has("expected_error")) {
            const auto expected = f.shape("expected_error");
            same_cells("expected_error", {points[0], expected.size() == 3 ? expected[2] : 0},
                       "be (frames, strands, pieces)");
        }
        if (f.has("water")) rows("water", {water_columns}, double());
        if (!h.energy_kinds.empty()) rows("energy", {h.energy_kinds.size()}, float());
        if (!h.stages.empty())
            check_within(rows("stage_seconds", {h.stages.size()}, float()), f, "stage_seconds", 0, INFINITY,
                         h.stages.size());
    }
}
H5Reader::Written RunReader::written() const { return body_->file.written(); }
const std::string& RunReader::writer() const { return body_->file.writer(); }
RunReader::~RunReader() = default;
const RunHeader& RunReader::header() const { return body_->header; }
int RunReader::frames() const { return body_->frames; }
std::vector<double> RunReader::seconds() const { return body_->seconds; }
const std::string& RunReader::path() const { return body_->file.path(); }

RunFrame RunReader::frame(int index) const {
    const H5Reader& f = body_->file;
    if (index < 0 || index >= body_->frames)
        throw Error(f.path() + ": found frame " + std::to_string(index) + ", allowed 0 to " +
                    std::to_string(body_->frames - 1));
    const size_t row = size_t(index);
    const Strands& rest = body_->header.groom.rest;
    RunFrame out;
    auto read_strands = [&](const char* name) {
        Strands s(rest.count, rest.particles);
        f.read_row(name, row, &s.points.data()->x);
        for (size_t i = 0; i < s.points.size(); ++i)
            if (!std::isfinite(s.points[i].x + s.points[i].y + s.points[i].z))
                throw Error(f.path() + ": dataset '" + name + "', frame " + std::to_string(index) +
                            ", strand " + std::to_string(i / size_t(rest.particles)) +
                            ": found a position that is not finite");
        return s;
    };
    out.positions = read_strands("positions");
    if (f.has("displayed")) out.displayed = read_strands("displayed");
    if (!body_->header.energy_kinds.empty()) {
        out.energy.resize(body_->header.energy_kinds.size());
        f.read_row("energy", row, out.energy.data());
    }
    if (!body_->header.stages.empty()) {
        out.stage_seconds.resize(body_->header.stages.size());
        f.read_row("stage_seconds", row, out.stage_seconds.data());
    }
    if (f.has("contact")) {
        out.contact.resize(cells(rest));
        f.read_row("contact", row, out.contact.data());
    }
    if (f.has("living_saturation")) {
        out.saturation.resize(cells(rest));
        f.read_row("living_saturation", row, out.saturation.data());
        for (float sigma : out.saturation)
            if (!(sigma >= 0 && sigma <= 1))
                throw Error(f.path() + ": dataset 'living_saturation', frame " + std::to_string(index) +
                            ": found " + std::to_string(sigma) + ", allowed 0 to 1");
    }
    if (f.has("expected_error")) {
        const auto expected = f.shape("expected_error");
        out.expected_error.resize(expected[1] * expected[2]);
        f.read_row("expected_error", row, out.expected_error.data());
        for (float mean : out.expected_error)
            if (!(mean >= 0 && std::isfinite(mean)))
                throw Error(f.path() + ": dataset 'expected_error', frame " + std::to_string(index) +
                            ": found " + std::to_string(mean) +
                            ", allowed are finite distances of 0 or more");
    }
    if (f.has("water")) {
        out.water.resize(water_columns);
        f.read_row("water", row, out.water.data());
    }
    const double* h = body_->head.data() + row * 7;
    out.head = {{h[3], h[4], h[5], h[6]}, {h[0], h[1], h[2]}};
    out.seconds = body_->seconds[row];
    return out;
}

}  // namespace wetcurl
