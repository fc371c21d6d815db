// The model file.
#include "models/model_file.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "models/registry.h"

namespace wetcurl {
namespace {

constexpr const char* weights = "weights/";

std::vector<size_t> shape_of(const Tensor& t) { return {t.sizes().begin(), t.sizes().end()}; }

double number_in(const H5Reader& file, const std::string& name, double minimum, double maximum) {
    const double v = file.number(name);
    if (v >= minimum && v <= maximum) return v;
    std::ostringstream text;
    text << file.path() << ": " << name << ": found " << v << ", allowed " << minimum << " to " << maximum;
    throw Error(text.str());
}
int count_in(const H5Reader& file, const std::string& name, int minimum, int maximum) {
    const double v = number_in(file, name, minimum, maximum);
    if (v != std::floor(v))
        throw Error(file.path() + ": " + name + ": found " + std::to_string(v) + ", allowed whole numbers");
    return int(v);
}

// A network of a file without what its inputs and outputs are scaled by would run, and predict nonsense.
void require_arrays(const H5Reader& file, const ModelCard& card) {
    if (card.codec != "strand") return;
    const size_t inputs = size_t(card.input_channels), outputs = size_t(card.output_channels);
    struct Array {
        const char* name;
        size_t size;
        bool needed = true;
    };
    for (const auto& [name, size, needed] :
         {Array{"input_mean", inputs}, Array{"input_std", inputs}, Array{"output_scale", outputs},
          Array{"input_low", inputs, false}, Array{"input_high", inputs, false}}) {
        const auto found = card.arrays.find(name);
        if (found == card.arrays.end() && !needed) continue;
        if (found == card.arrays.end())
            throw Error(file.path() + ": array '" + name + "' is missing, needed are " +
                        std::to_string(size) + " values (train the model again)");
        if (found->second.size() != size)
            throw Error(file.path() + ": array '" + name + "' holds " + std::to_string(found->second.size()) +
                        " values, needed " + std::to_string(size));
    }
}

ModelCard card_of(const H5Reader& file) {
    ModelCard card;
    card.codec = file.text("codec");
    card.architecture = file.text("architecture");
    const Architecture* architecture = find_architecture(card.architecture);
    if (!architecture || architecture->codec != card.codec)
        throw Error(file.path() + ": found architecture '" + card.architecture + "' for codec '" +
                    card.codec + "', which is not known here (made by a newer wetcurl?)");
    card.width = number_in(file, "width", smallest_width, largest_width);
    card.input_channels = count_in(file, "input_channels", 1, 1 << 16);
    card.output_channels = count_in(file, "output_channels", 1, 1 << 16);
    card.upscale = count_in(file, "upscale", 1, 16);
    card.parameters = count_in(file, "parameters", 1, 2000000000);
    if (file.has_attribute("target")) card.target = file.text("target");
    if (card.target != "" && card.target != "strands" && card.target != "displayed")
        throw Error(file.path() + ": target: found '" + card.target + "', allowed strands, displayed");
    if (file.has_attribute("low")) card.low = file.text("low");
    if (card.low != "dry" && card.low != "wet")
        throw Error(file.path() + ": low: found '" + card.low + "', allowed dry, wet");
    if (file.has_attribute("low_substeps")) card.low_substeps = count_in(file, "low_substeps", 1, 1'000'000);
    card.recipe = file.text("recipe");
    card.inputs = file.text("inputs");
    for (const auto& name : file.list("numbers"))
        card.numbers[name] = file.read<double>("numbers/" + name, {1})[0];
    for (const auto& name : file.list("arrays")) card.arrays[name] = file.read<float>("arrays/" + name, {0});
    const Architecture& a = *architecture;
    if ((a.input_channels && card.input_channels != a.input_channels) ||
        card.output_channels != a.output_channels || card.upscale != a.upscale)
        throw Error(file.path() + ": found " + std::to_string(card.input_channels) + " input and " +
                    std::to_string(card.output_channels) + " output channels, upscale " +
                    std::to_string(card.upscale) + ", which " + a.name + " does not have");
    require_arrays(file, card);
    return card;
}

std::shared_ptr<TorchNetwork> model_of(const std::string& path, const ModelCard& card) {
    try {
        return make_model(card);
    } catch (const Error& error) {
        throw Error(path + ": " + error.what());
    }
}

}  // namespace

void write_weights(H5Writer& file, const TorchNetwork& model) {
    for (const auto& p : model.named_parameters()) {
        const Tensor host = p.value().detach().to(torch::kCPU, torch::kFloat).contiguous();
        file.write(weights + p.key(), host.data_ptr<float>(), shape_of(host));
    }
}

void read_weights(const H5Reader& file, TorchNetwork& model) {
    torch::NoGradGuard no_grad;
    auto parameters = model.named_parameters();
    for (const auto& name : file.list("weights"))
        if (!parameters.contains(name))
            throw Error(file.path() + ": weights '" + name + "' belong to no layer of this network");
    for (auto& p : parameters) {
        auto values = file.read<float>(weights + p.key(), shape_of(p.value()));
        p.value().copy_(torch::from_blob(values.data(), p.value().sizes()));
    }
}

void save_model(const std::string& path, const ModelCard& card, const TorchNetwork& model, bool overwrite) {
    save_model(OutputFile(path, overwrite), card, model);
}

void save_model(OutputFile place, const ModelCard& card, const TorchNetwork& model) {
    H5Writer file(std::move(place), model_format, model_version);
    file.attribute("codec", card.codec);
    file.attribute("architecture", card.architecture);
    file.attribute("width", card.width);
    file.attribute("input_channels", double(card.input_channels));
    file.attribute("output_channels", double(card.output_channels));
    file.attribute("upscale", double(card.upscale));
    file.attribute("parameters", double(parameter_count(model)));
    if (!card.target.empty()) file.attribute("target", card.target);
    if (card.codec != "adhesion") file.attribute("low", card.low);
    if (card.low_substeps) file.attribute("low_substeps", double(card.low_substeps));
    file.attribute("recipe", card.recipe);
    file.attribute("inputs", card.inputs);
    for (const auto& [name, value] : card.numbers) file.write("numbers/" + name, &value, {1});
    for (const auto& [name, values] : card.arrays) file.write("arrays/" + name, values);
    write_weights(file, model);
    file.commit();
}

ModelCard read_card(const std::string& path) { return card_of(H5Reader(path, model_format, model_version)); }

std::pair<ModelCard, std::shared_ptr<TorchNetwork>> load_model(const std::string& path) {
    const H5Reader file(path, model_format, model_version);
    ModelCard card = card_of(file);
    auto model = model_of(path, card);
    read_weights(file, *model);
    if (parameter_count(*model) != card.parameters)
        throw Error(path + ": claims " + std::to_string(card.parameters) + " parameters, its network has " +
                    std::to_string(parameter_count(*model)));
    return {card, model};
}

}  // namespace wetcurl
