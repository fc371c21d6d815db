// What training minimises.
// Ours, Eq 17, Eq 20.
#include "training/losses.h"

#include "learn/codec/dct.h"

namespace wetcurl {
namespace {

// Decoding is linear: every distance is a norm of D e, e the error of the amplitudes, D the basis or its
// differences along the strand. One product gives all that the weights ask for. Distances are told by the
// mean length of strands in their scene, so that a scene of long hair teaches no more than one of short.
class StrandLoss : public Loss {
  public:
    StrandLoss(const Recipe& recipe, int particles, torch::Device device)
        : particles_(particles),
          length_weight_(recipe.length),
          steady_weight_(recipe.steady),
          doubt_weight_(recipe.doubt) {
        const StrandDct dct(particles);
        const Tensor basis =
            torch::from_blob(const_cast<float*>(dct.basis().data()), {dct_kept, particles}).t();
        const long n = particles;
        const Tensor edges = basis.narrow(0, 1, n - 1) - basis.narrow(0, 0, n - 1);  // (n-1, 24)
        // Particle 0 is exact by construction, and the norm has no gradient there.
        positions_ =
            (basis.narrow(0, 1, n - 1) - basis.narrow(0, 0, 1)).contiguous().to(device);  // (n-1, 24)
        edges_ = edges.contiguous().to(device);
        Tensor pieces = torch::zeros({n - 1, error_pieces});
        for (long i = 0; i + 1 < n; ++i) pieces[i][i * error_pieces / (n - 1)] = 1;
        pieces_ = (pieces / pieces.sum(0).clamp_min(1)).to(device);

        std::vector<Tensor> rows, weights;
        auto add = [&](double weight, const Tensor& d, double scale) {
            if (weight == 0 || d.size(0) == 0) return;
            rows.push_back(d.to(device));
            weights.push_back(torch::full({d.size(0)}, weight / scale).to(device));
        };
        add(recipe.position, positions_, double(n));
        add(recipe.edge, edges, 1);  // n - 1 of them, of which each is so much of a length
        if (n > 2)
            add(recipe.curvature, edges.narrow(0, 1, n - 2) - edges.narrow(0, 0, n - 2),
                double(n - 2) / double(n - 1));
        if (rows.empty()) return;
        rows_ = torch::cat(rows).contiguous();
        weights_ = torch::cat(weights);
    }

    Tensor of(const Tensor& output, const Batch& batch) const override {
        const Tensor rows = rows_of(output, batch), given = amplitudes_of(rows) * batch.relative_length,
                     target = batch.target.flatten(1) * batch.relative_length, error = given - target;
        Tensor loss = torch::zeros({}, error.options());
        if (rows_.defined()) loss = (norms(error, rows_) * weights_).sum() / error.size(0);
        if (length_weight_ > 0) {
            const Tensor found = norms(batch.base * batch.relative_length + given, edges_);
            const Tensor wanted = norms(batch.base * batch.relative_length + target, edges_);
            loss = loss + (found - wanted).abs().mean() * (length_weight_ * double(particles_ - 1));
        }
        if (batch.in_pairs) {
            const long half = error.size(0) / 2;
            const Tensor change = error.narrow(0, half, half) - error.narrow(0, 0, half);
            loss = loss + norms(change, positions_).sum() * (steady_weight_ / double(half * particles_));
        }
        return doubt_weight_ > 0 ? loss + doubt_weight_ * doubt(rows, error, batch.relative_length) : loss;
    }
    Tensor base_output(const Batch& batch) const override {
        const Tensor& x = batch.input;
        return torch::zeros({x.size(0), strand_outputs, x.size(2), x.size(3)}, x.options());
    }
    Tensor distance(const Tensor& output, const Batch& batch) const override {
        const Tensor error = (amplitudes_of(rows_of(output, batch)) - batch.target.flatten(1)) * batch.length;
        return norms(error, positions_).sum() / double(error.size(0) * particles_);
    }
    double count(const Batch& batch) const override { return double(batch.target.size(0)); }

  private:
    static Tensor amplitudes_of(const Tensor& rows) {
        return rows.narrow(1, answered_amplitudes.first, answered_amplitudes.count);
    }

    // How badly errors are told: the negative logarithm of their likelihood, were they exponentially
    // distributed with the means that are answered. What is wrong with the strands themselves is not asked.
    Tensor doubt(const Tensor& rows, const Tensor& error, const Tensor& relative_length) const {
        const Tensor told = rows.narrow(1, answered_errors.first, answered_errors.count),
                     found =
                         norms(error.detach(), positions_).matmul(pieces_) / (usual_error * relative_length);
        // Below any error there is, a straight line: hair that is new to a network may be told anything.
        constexpr double least = -10;
        const Tensor below = 1 + (least - told).clamp_min(0);
        return (found.clamp_min(std::exp(least)) * torch::exp(-told.clamp_min(least)) * below + told).mean();
    }

    // What was given for the masked pixels (P, strand_outputs).
    static Tensor rows_of(const Tensor& output, const Batch& batch) {
        const Tensor rows = to_rows(output);
        return batch.pixels.defined() ? rows.index_select(0, batch.pixels) : rows;
    }

    // Amplitudes (P, 72) and rows D (R, 24) to |D c| (P, R). Below a billionth of the unit the norm is
    // rounded off, so that its gradient stays finite at 0.
    static Tensor norms(const Tensor& amplitudes, const Tensor& rows) {
        const Tensor decoded = linear_rows(amplitudes.reshape({-1, dct_kept}), rows);  // (3 P, R)
        return decoded.view({-1, 3, rows.size(0)}).square().sum(1).add(1e-18).sqrt();
    }

    int particles_;
    double length_weight_, steady_weight_, doubt_weight_;
    Tensor positions_, edges_, rows_, weights_;
    Tensor pieces_;  // (n-1, error_pieces): means over them
};

class RootLoss : public Loss {
  public:
    explicit RootLoss(double diagonal) : diagonal_(diagonal) {}
    // The output is up(input) + x and the target up(input) + r, so their difference is Eq 17's r - x.
    Tensor of(const Tensor& output, const Batch& batch) const override {
        return 0.5 * ((output - batch.target).square() * batch.mask).sum() / pixels(batch);
    }
    Tensor base_output(const Batch& batch) const override { return batch.base; }
    Tensor distance(const Tensor& output, const Batch& batch) const override {
        const Tensor squares = (output - batch.target).square().sum(1, true);
        return (squares.sqrt() * batch.mask).sum() / pixels(batch) * diagonal_;
    }
    double count(const Batch& batch) const override { return batch.mask.sum().item<double>(); }

  private:
    // A patch may hold no strand: it counts nothing.
    static Tensor pixels(const Batch& batch) { return batch.mask.sum().clamp_min(1); }
    double diagonal_;
};

class AdhesionLoss : public Loss {
  public:
    Tensor of(const Tensor& output, const Batch& batch) const override {
        return (output - batch.target).square().mean();
    }
    Tensor base_output(const Batch& batch) const override { return batch.base; }
    Tensor distance(const Tensor&, const Batch&) const override { return {}; }
    double count(const Batch& batch) const override { return double(batch.target.size(0)); }
};

}  // namespace

std::unique_ptr<Loss> make_loss(Codec codec, const Recipe& recipe, int particles, double unit,
                                torch::Device device) {
    switch (codec) {
        case Codec::strand:
            return std::make_unique<StrandLoss>(recipe, particles, device);
        case Codec::root:
            return std::make_unique<RootLoss>(unit);
        default:
            return std::make_unique<AdhesionLoss>();
    }
}

}  // namespace wetcurl
