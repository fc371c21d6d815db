// The training loop: data, model, optimise, validate, keep the best, leave a checkpoint.
#include "training/loop.h"

#include <ATen/Context.h>
#include <c10/core/DeviceGuard.h>
#include <torch/utils.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <filesystem>
#include <numbers>
#include <optional>
#include <sstream>

#include "base/interrupt.h"
#include "base/output_file.h"
#include "base/strands.h"
#include "models/device.h"
#include "models/model_file.h"
#include "models/registry.h"
#include "training/checkpoint.h"
#include "training/data.h"
#include "training/group.h"
#include "training/losses.h"
#include "training/metrics_log.h"
#include "training/optimiser.h"
#include "training/recipe.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;

class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    void restart() { start_ = Clock::now(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

// Sums over batches, which processes add up: doubles alone.
struct ValidationSums {
    double samples = 0, with_positions = 0;  // batches with positions
    // Weighed by the samples; base: of no network at all.
    double loss = 0, base_loss = 0, distance = 0, base_distance = 0;
    double contacts = 0, squares_in_contact = 0, base_squares_in_contact = 0;  // adhesion
};
struct DistanceSums {
    double samples = 0, distance = 0;
};

struct Validation {
    double loss = 0, base_loss = 0;          // the same loss of no network at all
    double distance = 0, base_distance = 0;  // [m]
    bool positions = false;
    double contact_loss = 0, contact_base_loss = 0;  // adhesion: over the samples in contact

    explicit Validation(const ValidationSums& sums)
        : loss(mean(sums.loss, sums.samples)),
          base_loss(mean(sums.base_loss, sums.samples)),
          distance(mean(sums.distance, sums.samples)),
          base_distance(mean(sums.base_distance, sums.samples)),
          positions(sums.with_positions > 0),
          contact_loss(mean(sums.squares_in_contact, sums.contacts)),
          contact_base_loss(mean(sums.base_squares_in_contact, sums.contacts)) {}
    // Of adhesion, whose loss is a mean square in units of the largest force of Eq 11.
    std::vector<std::pair<std::string, double>> nrmse() const {
        return {{"validation_nrmse", std::sqrt(loss)},
                {"base_nrmse", std::sqrt(base_loss)},
                {"validation_nrmse_in_contact", std::sqrt(contact_loss)},
                {"base_nrmse_in_contact", std::sqrt(contact_base_loss)}};
    }
    // For the log.
    std::vector<std::pair<std::string, double>> line() const {
        std::vector<std::pair<std::string, double>> out = {{"validation_loss", loss},
                                                           {"base_loss", base_loss}};
        if (positions) {
            out.insert(out.end(), {{"validation_mm", 1e3 * distance}, {"base_mm", 1e3 * base_distance}});
        } else {
            for (const auto& value : nrmse()) out.push_back(value);
        }
        return out;
    }
    static double mean(double sum, double count) { return sum / std::max(count, 1.0); }
};

class Trainer {
  public:
    explicit Trainer(const TrainRequest& request)
        : request_(request), ranks_(request.ranks), device_(torch::kCPU) {}

    void run() {
        secure_output();
        if (already_done()) return;
        open_inputs();
        make_network();
        if (!resume()) start_anew();
        // What is likely to fail in one process alone has been done: the others would wait for it.
        group_ = std::make_unique<Group>(ranks_, device_, work());
        if (ranks_.first())
            log_ = std::make_unique<MetricsLog>(request_.output + ".jsonl", state_.log_position);
        InterruptGuard interrupt;
        if (!request_.from.empty() && optimiser_->steps == 0 && state_.best_epoch < 0) look_at_start();
        Stopwatch since_checkpoint;
        for (; state_.epoch < epochs_; ++state_.epoch) {
            data_->begin_epoch(state_.epoch);
            for (; state_.step < data_->steps(); ++state_.step) {
                if (ranks_.alone() ? interrupt.asked() : stop_agreed_) stop();
                // Between looks, which all processes take together, one alone would have to fail.
                if (taken_.empty() && since_checkpoint.seconds() > recipe_.checkpoint_seconds) {
                    checkpoint();
                    since_checkpoint.restart();
                }
                optimise(data_->batch(state_.step), interrupt.asked());
            }
            finish_epoch();
        }
        finish();
    }

  private:
    std::string checkpoint_path() const { return request_.output + ".checkpoint"; }
    void say(const std::string& text) const {
        if (request_.log) request_.log(text);
    }

    // Whether a training that is asked to go on has nothing left to do.
    bool already_done() const {
        const bool model = fs::exists(request_.output), checkpoint = fs::exists(checkpoint_path());
        if (request_.resume && model && !checkpoint) {
            say(request_.output + ": is complete, nothing to resume");
            return true;
        }
        if (model && !request_.overwrite && !request_.resume)
            throw Error(request_.output + ": is there already; --overwrite replaces it");
        if (checkpoint && !request_.overwrite && !request_.resume)
            throw Error(checkpoint_path() +
                        ": an interrupted training is there; --resume goes on, --overwrite begins anew");
        return false;
    }

    // From here on no other training writes the model, its log or its checkpoint. Processes that share this
    // one write through the first of them.
    void secure_output() {
        if (ranks_.first()) place_.emplace(request_.output, request_.overwrite || request_.resume);
    }

    void open_inputs() {
        if (request_.pairs.empty()) throw Misuse("train: no pairs file is named");
        for (const auto* list : {&request_.pairs, &request_.validation})
            for (const auto& path : *list) {
                readers_.push_back(std::make_unique<PairsReader>(path));
                inputs_ += (inputs_.empty() ? "" : "\n") + path + " " + hash_of_file(path) +
                           (list == &request_.validation ? " (held out)" : "");
            }
        if (!request_.from.empty())
            inputs_ += "\n" + request_.from + " " + hash_of_file(request_.from) + " (begun with)";
        codec_ = readers_.front()->codec();
        if (request_.kind != "sr" && request_.kind != "adhesion")
            throw Misuse("train: found '" + request_.kind + "', allowed sr, adhesion");
        if ((request_.kind == "adhesion") != (codec_ == Codec::adhesion))
            throw Misuse("train " + request_.kind + ": " + request_.pairs.front() + " holds pairs of codec " +
                         name_of(codec_));
        std::vector<std::string> names;
        for (const auto& a : architectures())
            if (a.codec == name_of(codec_)) names.push_back(a.name);
        recipe_ = read_recipe(request_, codec_, names);
        architecture_ = architecture_for(recipe_.architecture, name_of(codec_), recipe_.width);
        epochs_ = long(recipe_.epochs);
        std::vector<PairsReader*> pointers;
        for (const auto& reader : readers_) pointers.push_back(reader.get());
        set_threads(request_.threads);
        device_ = device_named(device_of(recipe_.device, ranks_));
        if (device_.is_cuda()) device_guard_.reset_device(device_);
        if (!recipe_.leave_out.empty() && !request_.from.empty())
            throw Misuse("leave_out: found with --from " + request_.from +
                         ", which looks at what it learned to look at; allowed is one of them");
        data_ = open_data(pointers, request_.pairs.size(), recipe_, device_, ranks_);
    }

    void make_network() {
        const bool in_bfloat16 = recipe_.precision == "bfloat16";
        choose(recipe_.deterministic ? Convolutions::repeatable : Convolutions::fastest);
        at::globalContext().setAllowTF32CuDNN(in_bfloat16);  // "float" means single precision throughout
        card_.codec = architecture_.codec;
        card_.architecture = architecture_.name;
        card_.width = recipe_.width;
        card_.output_channels = architecture_.output_channels;
        card_.upscale = architecture_.upscale;
        if (codec_ != Codec::adhesion) {
            card_.low = readers_.front()->low();
            card_.low_substeps = low_substeps();
        }
        data_->describe(card_);
        torch::manual_seed(uint64_t(recipe_.seed));
        model_ = request_.from.empty() ? make_model(card_) : begun_with(request_.from);
        model_->to(device_);
        if (in_bfloat16) model_->body = torch::kBFloat16;
        card_.parameters = parameter_count(*model_);
        optimiser_ = std::make_unique<Optimiser>(*model_, recipe_.weight_decay, recipe_.gradient_clip);
        loss_ = make_loss(codec_, recipe_, readers_.front()->particles(), data_->unit(), device_);
        total_steps_ = epochs_ * data_->steps();
        say(card_.architecture + ", " + std::to_string(card_.parameters) + " parameters, " +
            std::to_string(epochs_) + " epochs of " + std::to_string(data_->steps()) + " steps on " +
            recipe_.device + (ranks_.alone() ? "" : ", " + std::to_string(ranks_.of) + " processes"));
    }

    // The fewest of all.
    int low_substeps() const {
        int fewest = readers_.front()->low_substeps();
        for (const auto& reader : readers_) fewest = std::min(fewest, reader->low_substeps());
        return fewest;
    }

    // The network of a model file, whose inputs and outputs stay scaled as they are there.
    std::shared_ptr<TorchNetwork> begun_with(const std::string& path) {
        auto [card, model] = load_model(path);
        auto require_same = [&](const char* what, const auto& found, const auto& here) {
            std::ostringstream text;
            text << "train --from " << path << ": found " << what << ' ' << found << ", allowed here is "
                 << here;
            if (!(found == here)) throw Misuse(text.str());
        };
        require_same("codec", card.codec, card_.codec);
        require_same("architecture", card.architecture, card_.architecture);
        require_same("width", card.width, card_.width);
        require_same("input channels", card.input_channels, card_.input_channels);
        require_same("low-resolution strands", card.low, card_.low);
        if (codec_ == Codec::root && card.arrays != card_.arrays)
            throw Misuse("train --from " + path + ": its colours are of another box than these pairs'");
        std::swap(card_.arrays, card.arrays);
        widen_ranges(card.arrays);
        return model;
    }

    // It will have learned from both: what the network begun with did, and these pairs.
    void widen_ranges(const std::map<std::string, std::vector<float>>& own) {
        for (const bool low : {true, false}) {
            const char* const name = low ? "input_low" : "input_high";
            const auto before = card_.arrays.find(name);
            const auto now = own.find(name);
            if (before == card_.arrays.end() || now == own.end()) continue;
            for (size_t c = 0; c < now->second.size(); ++c) {
                float& end = before->second[c];
                end = low ? std::min(end, now->second[c]) : std::max(end, now->second[c]);
            }
        }
    }

    // What all processes must agree on.
    std::string work() const {
        return recipe_.text + inputs_ + "\nfrom epoch " + std::to_string(state_.epoch + 1) + ", step " +
               std::to_string(state_.step + 1);
    }

    bool resume() {
        if (!request_.resume) return false;
        if (!fs::exists(checkpoint_path())) {
            say(checkpoint_path() + ": no checkpoint is there to resume; training begins anew");
            return false;
        }
        state_ = load_checkpoint(checkpoint_path(), optimiser_->weights.numel());
        if (state_.recipe != recipe_.text)
            throw Misuse(checkpoint_path() + ": was made with another recipe:\n" + state_.recipe +
                         "now it is\n" + recipe_.text);
        if (state_.inputs != inputs_)
            throw Error(checkpoint_path() + ": was made from other pairs: found " + state_.inputs + ", now " +
                        inputs_);
        optimiser_->take(optimiser_->weights, state_.weights);
        optimiser_->take(optimiser_->first_moment, state_.first_moment);
        optimiser_->take(optimiser_->second_moment, state_.second_moment);
        optimiser_->steps = state_.optimiser_steps;
        first_step_ = optimiser_->steps;
        say("going on at epoch " + std::to_string(state_.epoch + 1) + " of " + std::to_string(epochs_));
        return true;
    }

    void start_anew() {
        state_.recipe = recipe_.text;
        state_.inputs = inputs_;
        state_.best = optimiser_->as_on_cpu(optimiser_->weights);
    }

    double learning_rate() const {
        if (recipe_.schedule == "constant") return recipe_.learning_rate;
        const double done = double(optimiser_->steps) / double(total_steps_);
        return recipe_.learning_rate * 0.5 * (1 + std::cos(std::numbers::pi * done));
    }

    Tensor output_of(const Batch& batch) {
        model_->whole_grid = !batch.pixels.defined();
        return model_->forward(batch.input);
    }

    // The loss of a batch, its gradient to the optimiser.
    Tensor differentiate(const Batch& host) {
        const Batch batch = host.to(device_);
        const Tensor loss = loss_->of(output_of(batch), batch);
        loss.backward();
        return loss.detach();
    }

    // The same of a batch that processes share: sums over each one's samples, added up, over the count of
    // all.
    Tensor differentiate_share(const Batch& host, bool asked_to_stop) {
        const Tensor extra = optimiser_->extra();
        if (!host.empty()) {
            const double count = loss_->count(host);
            const Batch batch = host.to(device_);
            const Tensor loss = count * loss_->of(output_of(batch), batch);
            loss.backward();
            extra[Optimiser::loss].copy_(loss.detach());
            extra[Optimiser::samples].fill_(count);
        }
        extra[Optimiser::stops].fill_(asked_to_stop ? 1 : 0);
        group_->sum(optimiser_->shared);
        const Tensor samples = extra[Optimiser::samples].clamp_min(1);
        optimiser_->gradient().div_(samples);
        return extra[Optimiser::loss] / samples;
    }

    // One step, and now and then a look at what came of the last ones.
    void optimise(const Batch& batch, bool asked_to_stop) {
        optimiser_->clear_gradients();
        const Tensor loss = ranks_.alone() ? differentiate(batch) : differentiate_share(batch, asked_to_stop);
        const double rate = learning_rate();
        taken_.push_back({loss, optimiser_->step(rate), rate});
        const long apart = request_.looks_apart ? request_.looks_apart : device_.is_cuda() ? 32 : 1;
        if ((state_.step + 1) % apart != 0 && state_.step + 1 != data_->steps()) return;
        const double value = look_at_steps();
        if (!ranks_.alone()) stop_agreed_ = optimiser_->extra()[Optimiser::stops].item<float>() > 0;
        if (request_.progress) {
            std::ostringstream note;
            note.precision(3);
            note << "loss " << value << best_note_;
            request_.progress(optimiser_->steps - first_step_, total_steps_ - first_step_, note.str());
        }
    }

    // Adds up the losses of steps since the last look, and returns the last one's.
    double look_at_steps() {
        if (taken_.empty()) return 0;
        std::vector<Tensor> numbers;
        for (const auto& step : taken_) numbers.insert(numbers.end(), {step.loss, step.norm});
        const Tensor found = torch::stack(numbers).to(torch::kCPU, torch::kDouble);
        const double* const value = found.data_ptr<double>();
        for (size_t k = 0; k < taken_.size(); ++k) {
            if (!std::isfinite(value[2 * k]) || !std::isfinite(value[2 * k + 1]))
                fail_diverged(optimiser_->steps - long(taken_.size() - k) + 1, value[2 * k], value[2 * k + 1],
                              taken_[k].rate);
            state_.loss_sum += value[2 * k];
        }
        const double last = value[2 * (taken_.size() - 1)];
        taken_.clear();
        return last;
    }

    [[noreturn]] void fail_diverged(long step, double loss, double gradient, double rate) const {
        std::ostringstream text;
        text << request_.output << ": training diverged at step " << step << " (epoch " << state_.epoch + 1
             << "): loss " << loss << ", norm of the gradient " << gradient << ", learning_rate " << rate
             << "; a smaller learning_rate or gradient_clip = 1 may help";
        throw Error(text.str());
    }

    // Of all processes together; `Sums` holds doubles alone.
    template <class Sums>
    Sums summed(const Sums& own) {
        using Numbers = std::array<double, sizeof(Sums) / sizeof(double)>;
        Numbers numbers = std::bit_cast<Numbers>(own);
        const Tensor all = torch::tensor(at::ArrayRef<double>(numbers), torch::kDouble).to(device_);
        group_->sum(all);
        const Tensor found = all.cpu();
        std::copy_n(found.data_ptr<double>(), numbers.size(), numbers.begin());
        return std::bit_cast<Sums>(numbers);
    }

    Validation validate() {
        const torch::NoGradGuard no_grad;
        ValidationSums sums;
        for (long i = ranks_.mine; i < data_->validation_batches(); i += ranks_.of) {
            const Batch batch = data_->validation_batch(i).to(device_);
            const Tensor output = output_of(batch), base = loss_->base_output(batch);
            const double weight = loss_->count(batch);
            auto add = [&](double& to, const Tensor& value) { to += weight * value.item<double>(); };
            add(sums.loss, loss_->of(output, batch));
            add(sums.base_loss, loss_->of(base, batch));
            if (const Tensor distance = loss_->distance(output, batch); distance.defined()) {
                add(sums.distance, distance);
                add(sums.base_distance, loss_->distance(base, batch));
                ++sums.with_positions;
            }
            sums.samples += weight;
            if (codec_ == Codec::adhesion) {
                auto squares = [&](const Tensor& of) {
                    return ((of - batch.target).square() * batch.mask).sum().item<double>();
                };
                sums.squares_in_contact += squares(output);
                sums.base_squares_in_contact += squares(base);
                sums.contacts += batch.mask.sum().item<double>();
            }
        }
        return Validation(summed(sums));
    }

    // Mean distance [m] of the first batches that this epoch drew, by the weights after it; none where the
    // codec has no distances.
    std::optional<double> training_distance() {
        constexpr long most = 8;
        if (codec_ == Codec::adhesion) return {};
        const torch::NoGradGuard no_grad;
        DistanceSums sums;
        for (long step = 0; step < std::min(most, data_->steps()); ++step) {
            const Batch host = data_->batch(step);
            if (host.empty()) continue;
            const Batch batch = host.to(device_);
            const double weight = loss_->count(batch);
            sums.distance += weight * loss_->distance(output_of(batch), batch).item<double>();
            sums.samples += weight;
        }
        sums = summed(sums);
        return sums.distance / std::max(sums.samples, 1.0);
    }

    // What training begins with is the best there is yet, where held-out data say how good.
    void look_at_start() {
        if (!data_->validation_batches()) return;
        const Validation found = validate();
        if (std::isfinite(found.loss)) state_.best_loss = found.loss, state_.best_epoch = 0;
        if (found.positions) {
            state_.begun_with = found.distance;
            std::ostringstream text;
            text.precision(3);
            text << request_.from << ": held out " << 1e3 * found.distance << " mm (base "
                 << 1e3 * found.base_distance << ")";
            say(text.str());
        }
        std::vector<std::pair<std::string, double>> line = {{"epoch", 0}, {"step", 0}};
        for (const auto& value : found.line()) line.push_back(value);
        if (log_) log_->line(line);
    }

    // The end of an epoch: its line in the log, a validation where one is due, the best kept.
    void finish_epoch() {
        const double mean_loss = state_.loss_sum / double(data_->steps());
        std::vector<std::pair<std::string, double>> line = {{"epoch", double(state_.epoch + 1)},
                                                            {"step", double(optimiser_->steps)},
                                                            {"loss", mean_loss},
                                                            {"learning_rate", learning_rate()},
                                                            {"seconds", watch_.seconds()}};
        const bool due =
            (state_.epoch + 1) % long(recipe_.validate_every) == 0 || state_.epoch + 1 == epochs_;
        if (due)
            if (const auto distance = training_distance()) line.emplace_back("training_mm", 1e3 * *distance);
        if (due && data_->validation_batches() > 0) {
            const Validation found = validate();
            for (const auto& value : found.line()) line.push_back(value);
            std::ostringstream note;
            note.precision(3);
            if (found.positions) {
                note << ", held out " << 1e3 * found.distance << " mm (";
                if (state_.begun_with >= 0) note << "begun with " << 1e3 * state_.begun_with << ", ";
                note << "base " << 1e3 * found.base_distance << ")";
            } else {
                note << ", held out nRMSE " << std::sqrt(found.loss) << " (force of the step before "
                     << std::sqrt(found.base_loss) << "), in contact " << std::sqrt(found.contact_loss)
                     << " (" << std::sqrt(found.contact_base_loss) << ")";
            }
            best_note_ = note.str();
            keep_if_best(found.loss);
        } else if (due) {
            keep_if_best(mean_loss);
        }
        if (log_) log_->line(line);
        state_.loss_sum = 0;
        state_.step = 0;
    }

    void keep_if_best(double loss) {
        if (state_.best_epoch >= 0 && !(loss < state_.best_loss)) return;
        state_.best = optimiser_->as_on_cpu(optimiser_->weights);
        state_.best_loss = loss;
        state_.best_epoch = state_.epoch + 1;
    }

    void checkpoint() {
        if (!ranks_.first()) return;
        state_.weights = optimiser_->as_on_cpu(optimiser_->weights);
        state_.first_moment = optimiser_->as_on_cpu(optimiser_->first_moment);
        state_.second_moment = optimiser_->as_on_cpu(optimiser_->second_moment);
        state_.optimiser_steps = optimiser_->steps;
        state_.log_position = log_->position();
        save_checkpoint(checkpoint_path(), state_);
    }

    [[noreturn]] void stop() {
        look_at_steps();  // of processes that agreed to stop there are none left
        checkpoint();
        group_->wait();  // a launcher ends all processes once one has ended
        throw Interrupted("interrupted at epoch " + std::to_string(state_.epoch + 1) + "; " +
                          checkpoint_path() + " is left, --resume goes on");
    }

    // The best weights become the model; its card says how good they are.
    void finish() {
        optimiser_->take(optimiser_->weights, state_.best);
        const Validation found = validate();
        card_.numbers["best_epoch"] = double(state_.best_epoch);
        if (state_.begun_with >= 0) card_.numbers["begun_with_mm"] = 1e3 * state_.begun_with;
        card_.numbers["best_loss"] = state_.best_loss;
        if (found.positions) {
            card_.numbers["validation_mm"] = 1e3 * found.distance;
            card_.numbers["base_mm"] = 1e3 * found.base_distance;
        } else if (data_->validation_batches() > 0) {
            for (const auto& [name, value] : found.nrmse()) card_.numbers[name] = value;
        }
        card_.recipe = recipe_.text;
        card_.inputs = inputs_;
        if (ranks_.first()) save();
        group_->wait();  // so that the model is there when any process ends
    }

    void save() {
        save_model(std::move(*place_), card_, *model_);
        fs::remove(checkpoint_path());
        std::ostringstream text;
        text.precision(4);
        text << request_.output << ": best at epoch " << state_.best_epoch << " of " << epochs_ << ", loss "
             << state_.best_loss << best_note_ << ", " << watch_.seconds() << " s";
        say(text.str());
    }

    const TrainRequest& request_;
    Ranks ranks_;
    torch::Device device_;
    c10::OptionalDeviceGuard device_guard_;
    std::vector<std::unique_ptr<PairsReader>> readers_;
    std::string inputs_;  // "file hash", one a line
    Codec codec_ = Codec::strand;
    Recipe recipe_{};
    Architecture architecture_{};
    long epochs_ = 0, total_steps_ = 0, first_step_ = 0;
    std::unique_ptr<TrainingData> data_;
    ModelCard card_;
    std::shared_ptr<TorchNetwork> model_;
    std::unique_ptr<Optimiser> optimiser_;
    std::unique_ptr<Loss> loss_;
    std::unique_ptr<Group> group_;
    // Of the first process.
    std::optional<OutputFile> place_;  // of the model
    std::unique_ptr<MetricsLog> log_;
    struct Taken {  // a step; on the device
        Tensor loss, norm;
        double rate;
    };
    std::vector<Taken> taken_;  // since the last look
    bool stop_agreed_ = false;
    TrainingState state_;
    std::string best_note_;
    Stopwatch watch_;
};

}  // namespace

void train(const TrainRequest& request) { Trainer(request).run(); }

}  // namespace wetcurl
