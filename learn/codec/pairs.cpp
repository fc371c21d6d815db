// The pairs file.
#include "learn/codec/pairs.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <utility>

#include "base/network_channels.h"

namespace wetcurl {

static const std::vector<std::string> codec_names{"strand", "root", "adhesion"};

std::string name_of(Codec codec) { return codec_names[size_t(codec)]; }

Codec codec_named(const std::string& name) {
    for (size_t c = 0; c < codec_names.size(); ++c)
        if (codec_names[c] == name) return Codec(c);
    throw Misuse("codec: found '" + name + "', allowed strand, root, adhesion" +
                 did_you_mean(name, codec_names));
}

static std::string group_name(int run) {
    char text[32];
    std::snprintf(text, sizeof text, "runs/%03d", run);
    return text;
}

PairsWriter::PairsWriter(OutputFile place, Codec codec, int particles)
    : file_(std::move(place), pairs_format, pairs_version) {
    file_.attribute("codec", name_of(codec));
    file_.attribute("particles", double(particles));
}

void PairsWriter::next_group() { group_ = group_name(runs_++); }

void PairsWriter::link(const std::string& file) {
    next_group();
    file_.link(group_, file, group_name(0));
}

void PairsWriter::begin(const StrandPairs& run) {
    next_group();
    const size_t h = size_t(run.height), w = size_t(run.width);
    file_.write(group_ + "/static", run.fixed.data(), {size_t(run.static_channels), h, w});
    file_.write(group_ + "/mask", run.mask.data(), {h, w});
    file_.write(group_ + "/length", run.length.data(), {h, w});
    if (!run.frame.empty()) file_.write(group_ + "/frame", run.frame);
    inputs_name_ = "/dynamic";
    inputs_shape_ = {size_t(run.dynamic_channels), h, w};
    target_shape_ = {size_t(strand_coefficients), h, w};
}

void PairsWriter::begin(const RootPairs& run) {
    next_group();
    const size_t h = size_t(run.height), w = size_t(run.width);
    file_.write(group_ + "/mask_low", run.mask_low.data(), {h, w});
    file_.write(group_ + "/mask", run.mask.data(), {2 * h, 2 * w});
    inputs_name_ = "/input";
    inputs_shape_ = {size_t(colour_channels), h, w};
    target_shape_ = {size_t(colour_channels), 2 * h, 2 * w};
}

void PairsWriter::append(const float* inputs, const float* target, const float* displayed) {
    file_.append(group_ + inputs_name_, inputs, inputs_shape_);
    file_.append(group_ + "/target", target, target_shape_);
    if (displayed) file_.append(group_ + "/displayed", displayed, target_shape_);
}

void PairsWriter::add(const std::vector<AdhesionSample>& samples) {
    next_group();
    std::vector<float> input, target;
    std::vector<uint8_t> contact;
    for (const auto& s : samples) {
        input.insert(input.end(), s.input.begin(), s.input.end());
        target.push_back(s.target);
        contact.push_back(s.contact);
    }
    file_.write(group_ + "/input", input.data(), {samples.size(), size_t(adhesion_inputs)});
    file_.write(group_ + "/target", target);
    file_.write(group_ + "/contact", contact);
}

void PairsWriter::low(bool wet, int substeps) {
    file_.attribute("low", std::string(wet ? "wet" : "dry"));
    if (substeps > 0) file_.attribute("low_substeps", double(substeps));
}

void PairsWriter::box(const double lower[3], const double upper[3]) {
    file_.write("b_min", lower, {3});
    file_.write("b_max", upper, {3});
}

PairsReader::PairsReader(const std::string& path)
    : file_(path, pairs_format, pairs_version, oldest_pairs_version) {
    codec_ = codec_named(file_.text("codec"));
    particles_ = file_.integer("particles", 2, 1 << 24);
    runs_ = file_.has("runs") ? int(file_.list("runs").size()) : 0;
    if (runs_ == 0) throw Error(path + ": no encoded run in it, allowed one or more (runs/000)");
}

std::string PairsReader::low() const {
    const std::string low = file_.has_attribute("low") ? file_.text("low") : "dry";
    if (low != "dry" && low != "wet") throw Error(path() + ": low: found '" + low + "', allowed dry, wet");
    return low;
}

int PairsReader::low_substeps() const {
    return file_.has_attribute("low_substeps") ? file_.integer("low_substeps", 1, 1'000'000) : 0;
}

void PairsReader::require(Codec wanted) const {
    if (codec_ != wanted)
        throw Error(path() + ": holds pairs of codec " + name_of(codec_) + ", needed is codec " +
                    name_of(wanted));
}

// The four sizes of a dataset of frames.
static std::vector<size_t> frames_shape(const H5Reader& file, const std::string& name) {
    const auto shape = file.shape(name);
    if (shape.size() != 4 || shape[0] == 0 || shape[1] == 0 || shape[2] == 0 || shape[3] == 0)
        throw Error(file.path() + ": " + name +
                    ": allowed is a shape (frames, channels, height, width), none of them 0");
    return shape;
}

static void require_shape(const H5Reader& file, const std::string& name, const std::vector<size_t>& wanted) {
    if (file.shape(name) == wanted) return;
    std::string text;
    for (size_t n : wanted) text += (text.empty() ? "(" : ", ") + std::to_string(n);
    throw Error(file.path() + ": " + name + ": its shape does not fit its group, allowed " + text + ")");
}

StrandPairs PairsReader::strand(int run) const {
    require(Codec::strand);
    const std::string group = group_name(run);
    const auto d = frames_shape(file_, group + "/dynamic");
    require_shape(file_, group + "/target", {d[0], size_t(strand_coefficients), d[2], d[3]});
    StrandPairs out;
    out.displayed = file_.has(group + "/displayed");
    if (out.displayed)
        require_shape(file_, group + "/displayed", {d[0], size_t(strand_coefficients), d[2], d[3]});
    out.frames = int(d[0]);
    out.dynamic_channels = int(d[1]);
    out.height = int(d[2]);
    out.width = int(d[3]);
    if (out.dynamic_channels < strand_coefficients)
        throw Error(path() + ": " + group + "/dynamic: found " + std::to_string(d[1]) +
                    " channels, allowed " + std::to_string(strand_coefficients) + " or more");
    out.fixed = file_.read<float>(group + "/static", {0, d[2], d[3]});
    out.static_channels = int(out.fixed.size() / out.pixels());
    out.mask = file_.read<uint8_t>(group + "/mask", {d[2], d[3]});
    out.length = file_.read<float>(group + "/length", {d[2], d[3]});
    if (file_.has(group + "/frame")) {
        out.frame = file_.read<int>(group + "/frame", {d[0]});
        if (std::adjacent_find(out.frame.begin(), out.frame.end(), std::greater_equal()) != out.frame.end())
            throw Error(path() + ": " + group + "/frame: allowed are rising numbers");
    }
    return out;
}

RootPairs PairsReader::root(int run) const {
    require(Codec::root);
    const std::string group = group_name(run);
    const auto d = frames_shape(file_, group + "/input");
    require_shape(file_, group + "/input", {d[0], size_t(colour_channels), d[2], d[3]});
    require_shape(file_, group + "/target", {d[0], size_t(colour_channels), 2 * d[2], 2 * d[3]});
    RootPairs out;
    out.frames = int(d[0]);
    out.height = int(d[2]);
    out.width = int(d[3]);
    out.mask_low = file_.read<uint8_t>(group + "/mask_low", {d[2], d[3]});
    out.mask = file_.read<uint8_t>(group + "/mask", {2 * d[2], 2 * d[3]});
    return out;
}

std::vector<AdhesionSample> PairsReader::adhesion(int run) const {
    require(Codec::adhesion);
    const std::string group = group_name(run);
    const auto input = file_.read<float>(group + "/input", {0, size_t(adhesion_inputs)});
    const size_t n = input.size() / adhesion_inputs;
    const auto target = file_.read<float>(group + "/target", {n});
    const auto contact = file_.read<uint8_t>(group + "/contact", {n});
    std::vector<AdhesionSample> out(n);
    for (size_t s = 0; s < n; ++s) {
        std::copy_n(input.data() + s * adhesion_inputs, adhesion_inputs, out[s].input.data());
        out[s].target = target[s];
        out[s].contact = contact[s];
    }
    return out;
}

void PairsReader::frame(int run, int frame, float* inputs, float* target, bool displayed) const {
    const std::string group = group_name(run);
    file_.read_row(group + (codec_ == Codec::strand ? "/dynamic" : "/input"), size_t(frame), inputs);
    file_.read_row(group + (displayed ? "/displayed" : "/target"), size_t(frame), target);
}

void PairsReader::box(double lower[3], double upper[3]) const {
    require(Codec::root);
    const auto l = file_.read<double>("b_min", {3}), u = file_.read<double>("b_max", {3});
    std::copy_n(l.data(), 3, lower);
    std::copy_n(u.data(), 3, upper);
}

}  // namespace wetcurl
