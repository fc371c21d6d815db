// Adam with decoupled weight decay (AdamW; Adam where the decay is 0), over one flat vector of weights.
// Kingma and Ba 2015, Loshchilov and Hutter 2019. Ours rather than LibTorch's: its state is three vectors
// that a checkpoint holds to the bit in any version, and a step is a handful of passes over them.
#pragma once

#include "models/layers.h"

namespace wetcurl {

class Optimiser {
  public:
    // Moves the model's weights and gradients into flat vectors of which they become views.
    Optimiser(TorchNetwork& model, double weight_decay, double gradient_clip);
    void clear_gradients() { shared.zero_(); }
    // One step down the gradient, whose norm, before clipping, it returns: on the device, which nobody waits
    // for. Where it is not finite the weights are worth nothing: look before they are kept.
    Tensor step(double learning_rate);

    // What processes sum besides the gradient: the loss, how many samples it is of, and how many of them
    // were asked to stop.
    enum Extra : long { loss, samples, stops, extras };
    // (n + extras): the gradient, and behind it these, which are cleared with it, so that what processes
    // share is one vector.
    Tensor shared;
    Tensor gradient() const { return gradient_; }
    Tensor extra() const { return shared.narrow(0, gradient_.numel(), extras); }

    // The whole state. (n); how a device lays weights out is its own matter, so that it leaves and comes as
    // the CPU has them.
    Tensor weights, first_moment, second_moment;
    Tensor as_on_cpu(const Tensor& part) const;
    void take(Tensor& part, const Tensor& as_on_cpu) const;
    long steps = 0;

  private:
    // Views of `flat`, which is laid out as `weights`, one a parameter.
    std::vector<Tensor> parts_of(const Tensor& flat) const;
    std::vector<Tensor> parameters_;
    double weight_decay_, clip_;
    Tensor gradient_;  // (n), of `shared`
};

}  // namespace wetcurl
