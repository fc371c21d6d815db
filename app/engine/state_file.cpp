// States of a run on disk.
#include "app/engine/state_file.h"

#include <fmt/format.h>
#include <omp.h>

#include <filesystem>

#include "base/log.h"

namespace wetcurl {

namespace {

constexpr const char* format = "wetcurl state";
constexpr int version = 1;
constexpr double most_share = 0.005;  // of a run's time

// Calls f(name, numbers, count) for each array of a state that is there.
template <class F>
void for_each_array(const RunState& state, F f) {
    for_each_state_array(
        [&](const StrandArrayInfo& info, const auto& array) {
            if (array.empty()) return;
            static_assert(sizeof array[0] % sizeof(double) == 0);
            f(info.label, reinterpret_cast<const double*>(array.data()),
              array.size() * sizeof array[0] / sizeof(double));
        },
        state);
    if (!state.saturation.empty()) f("saturation", state.saturation.data(), state.saturation.size());
    const double moment[] = {state.time, state.first ? 1.0 : 0.0};
    f("moment", moment, std::size(moment));
    for (const auto& [name, numbers] : state.carried) f(name.c_str(), numbers.data(), numbers.size());
}

std::string dataset_of(const std::string& name) { return "state/" + name; }

int frame_in(const H5Reader& f) { return f.integer("frame", 0, 1 << 30); }

}  // namespace

StateFacts facts_of(const RunHeader& header, const std::string& precision) {
    const std::string run = header.scene + header.groom.hash();
    return {hash_bytes(run.data(), run.size()), precision, header.device};
}

std::string state_file_of(const std::string& output) { return target_of(output) + ".state"; }

std::optional<int> frame_of_state(const std::string& file) {
    if (!std::filesystem::exists(file)) return std::nullopt;
    try {
        return frame_in(H5Reader(file, format, version));
    } catch (const Error& e) {
        log_warning(std::string(e.what()) + "; the state is left out, as if the file were not there");
        return std::nullopt;
    }
}

StoredState read_state(const std::string& file, const RunState& like, bool exactly) {
    const H5Reader f(file, format, version);
    StoredState out{frame_in(f), {f.text("run"), f.text("precision"), f.text("device")}, like};
    size_t arrays = 0;
    const auto has = [&](const std::string& name, size_t count) {
        return f.has(dataset_of(name)) && f.shape(dataset_of(name)) == std::vector<size_t>{count};
    };
    for_each_array(like, [&](const char* name, const double*, size_t count) {
        ++arrays;
        if (exactly && !has(name, count))
            throw Error(fmt::format(
                "{}: found no array '{}' of {} numbers, which this program goes on from (another version "
                "of the program?)",
                file, name, count));
    });
    if (const size_t found = f.list("state").size(); exactly && found != arrays)
        throw Error(fmt::format("{}: found {} arrays, {} are needed (another version of the program?)", file,
                                found, arrays));
    const auto read = [&](const std::string& name, double* to, size_t count) {
        if (!has(name, count)) return;
        const auto numbers = f.read<double>(dataset_of(name));
        std::copy(numbers.begin(), numbers.end(), to);
    };
    for_each_state_array(
        [&](const StrandArrayInfo& info, auto& array) {
            read(info.label, reinterpret_cast<double*>(array.data()),
                 array.size() * sizeof array[0] / sizeof(double));
        },
        out.state);
    read("saturation", out.state.saturation.data(), out.state.saturation.size());
    double moment[] = {like.time, 1};
    read("moment", moment, std::size(moment));
    out.state.time = moment[0], out.state.first = moment[1] != 0;
    for (auto& [name, numbers] : out.state.carried) read(name, numbers.data(), numbers.size());
    return out;
}

StateKeeper::StateKeeper(const std::string& output, StateFacts facts, bool kept)
    : file_(state_file_of(output)), facts_(std::move(facts)) {
    if (!kept) remove();
}

void StateKeeper::take(int frame, const Simulation& simulation) {
    const double begin = omp_get_wtime();
    taken_ = {frame, facts_, simulation.run_state()};
    cost_ = omp_get_wtime() - begin;
}

void StateKeeper::offer(int frame, const Simulation& simulation) {
    if (omp_get_wtime() >= due_) take(frame, simulation);
}

// Another file under the name of the one before: a kill leaves one or the other.
void StateKeeper::write() {
    if (!taken_) return;
    const double begin = omp_get_wtime();
    try {
        H5Writer f(file_, format, version, true);
        f.attribute("frame", double(taken_->frame));
        f.attribute("run", facts_.run);
        f.attribute("precision", facts_.precision);
        f.attribute("device", facts_.device);
        for_each_array(taken_->state, [&](const char* name, const double* numbers, size_t count) {
            f.write(dataset_of(name), numbers, {count});
        });
        f.commit();
    } catch (const Error& e) {
        // The run itself may go on; from where it can be resumed is another matter.
        log_warning(fmt::format("{}; a resumed run will begin at an earlier state", e.what()));
        std::error_code error;
        std::filesystem::remove(file_ + ".partial", error);
    }
    taken_.reset();
    const double end = omp_get_wtime();
    due_ = end + (cost_ + end - begin) / most_share;
}

void StateKeeper::leave(int frame, const Simulation& simulation) {
    take(frame, simulation);
    write();
}

void StateKeeper::remove() {
    std::error_code error;
    std::filesystem::remove(file_, error);
    std::filesystem::remove(file_ + ".partial", error);
}

}  // namespace wetcurl
