// The whole state of a training between two steps.
#include "training/checkpoint.h"

#include "base/hdf5.h"

namespace wetcurl {
namespace {

struct NamedTensor {
    const char* name;
    Tensor TrainingState::*member;
};
constexpr NamedTensor tensors[] = {{"weights", &TrainingState::weights},
                                   {"first_moment", &TrainingState::first_moment},
                                   {"second_moment", &TrainingState::second_moment},
                                   {"best", &TrainingState::best}};
struct NamedCount {
    const char* name;
    long TrainingState::*member;
};
constexpr NamedCount counts[] = {{"optimiser_steps", &TrainingState::optimiser_steps},
                                 {"epoch", &TrainingState::epoch},
                                 {"step", &TrainingState::step},
                                 {"best_epoch", &TrainingState::best_epoch},
                                 {"log_position", &TrainingState::log_position}};

}  // namespace

void save_checkpoint(const std::string& path, const TrainingState& state) {
    H5Writer file(path, checkpoint_format, checkpoint_version, /*overwrite=*/true);
    for (const auto& [name, member] : tensors) {
        const Tensor host = (state.*member).to(torch::kCPU).contiguous();
        file.write(name, host.data_ptr<float>(), {size_t(host.numel())});
    }
    for (const auto& [name, member] : counts) file.attribute(name, double(state.*member));
    file.attribute("loss_sum", state.loss_sum);
    file.attribute("best_loss", state.best_loss);
    file.attribute("begun_with", state.begun_with);
    file.attribute("recipe", state.recipe);
    file.attribute("inputs", state.inputs);
    file.commit();
}

TrainingState load_checkpoint(const std::string& path, long n) {
    const H5Reader file(path, checkpoint_format, checkpoint_version);
    TrainingState state;
    for (const auto& [name, member] : tensors) {
        auto values = file.read<float>(name, {size_t(n)});
        state.*member = torch::from_blob(values.data(), {n}).clone();
    }
    for (const auto& [name, member] : counts) state.*member = long(file.number(name));
    state.loss_sum = file.number("loss_sum");
    state.best_loss = file.number("best_loss");
    if (file.has_attribute("begun_with")) state.begun_with = file.number("begun_with");
    state.recipe = file.text("recipe");
    state.inputs = file.text("inputs");
    return state;
}

}  // namespace wetcurl
