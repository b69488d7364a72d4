#include "prior_backward.h"

#include <algorithm>
#include <cmath>

#include "hqs/plain_prior.h"
#include "hqs/two_modes_prior.h"
#include "hqs/u_shaped_prior.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/training/augmentation.h"
#include "kernels/two_modes.h"

namespace hqslam::nn {
namespace {

static_assert(kLeastTruth_m == kUnknownTruth_m);

/// The share of the likelihood of a range in the loss, beside the cross-entropy of a return.
constexpr float kRangeShare = 0.3F;

class PlainBackward final : public PriorBackward {
 public:
  explicit PlainBackward(PlainPrior& prior) : PriorBackward(prior), plain_(prior) {}

  void backward(const Candidates& /*candidates*/, const PriorState& state, PriorState& gradient,
                std::span<float> d_parameters) override {
    gradient.output() = gradient.z;
    gradient.output().fill_borders();
    graph_backward_.backward({&state.values, 1}, {&gradient.values, 1}, d_parameters,
                             {.dropped = plain_.dropped_out()});
  }

 private:
  const PlainPrior& plain_;
};

class UShapedBackward final : public PriorBackward {
 public:
  explicit UShapedBackward(UShapedPrior& prior)
      : PriorBackward(prior), u_shaped_(prior), shape_(prior.shape()) {}

  PriorState make_gradient() const override {
    PriorState gradient = prior_.make_state(false);
    // Two rows in one go cost fewer sums of lanes, more would leave the second-level cache.
    const int rows = gradient.z.rows() % 2 == 0 ? 2 : 1;
    gradient.part =
        Tensor(shape_.scores() + shape_.memory, rows, gradient.z.columns(), prior_.padding(), 0);
    if (shape_.neighbours_of_h) gradient.neighbours = prior_.make_tiles();
    return gradient;
  }

  void backward(const Candidates& candidates, const PriorState& state, PriorState& gradient,
                std::span<float> d_parameters) override {
    // gradient.z holds d_z; the direct way to H is kept there once the scores have theirs.
    Tensor& d_direct = gradient.z;
    Tensor& d_output = gradient.part;
    const CandidatesOf candidates_here = u_shaped_.candidates_of(candidates, state.input());
    if (shape_.neighbours_of_h) put_gradient_of_neighbours(state, gradient);
    const int scores = shape_.scores();
    for (int first = 0; first < gradient.z.rows(); first += d_output.rows()) {
      select_backward(candidates_here, state.input(), shape_.tile,
                      prior_.graph().engine().instruction_set, first, state.output(), gradient.z,
                      d_output, d_direct);
      for (int y = 0; y < d_output.rows(); ++y) {
        for (int channel = 0; channel < shape_.memory; ++channel) {
          std::copy_n(gradient.output().row(channel, first + y), d_output.columns(),
                      d_output.row(scores + channel, y));
        }
      }
      graph_backward_.last_backward_rows(state.values, first, d_output, gradient.values,
                                         d_parameters);
    }
    graph_backward_.backward({&state.values, 1}, {&gradient.values, 1}, d_parameters,
                             {.left_out = 1});
    add_channels(d_direct, 0, gradient.input());
    if (shape_.neighbours_of_h) add_channels(gradient.neighbours, 0, gradient.input());
  }

 private:
  /// d loss / d H through the neighbours, which are H's own: of d_z their weights' share.
  void put_gradient_of_neighbours(const PriorState& state, PriorState& gradient) const {
    const int pixels = shape_.tile.pixels();
    gradient.neighbours.set_zero();
    for (int row = 0; row < gradient.z.rows(); ++row) {
      for (int channel = 0; channel < pixels; ++channel) {
        const float* passed = gradient.z.row(channel, row);
        const float* weight_above = state.output().row(channel, row);
        const float* weight_below = state.output().row(pixels + channel, row);
        float* above = u_shaped_.above(channel, row, gradient.neighbours);
        float* below = u_shaped_.below(channel, row, gradient.neighbours);
        for (int x = 0; x < gradient.z.columns(); ++x) {
          above[x] += weight_above[x] * passed[x];
          below[x] += weight_below[x] * passed[x];
        }
      }
    }
  }

  const UShapedPrior& u_shaped_;
  const UShapedPriorShape& shape_;
};

class TwoModesBackward final : public PriorBackward {
 public:
  explicit TwoModesBackward(TwoModesPrior& prior) : PriorBackward(prior), modes_(prior) {}

  /// In metres.
  void put_truth(const RangeImage& truth_m, float /*range_scale_m*/, Tensor& tiles) const override {
    to_tiles(truth_m.range_m.data(), prior_.tile(), tiles);
  }
  /// The likelihood of the truth (kernels/two_modes.h). Leaves the gradient of the head's
  /// result, from which `backward` goes on.
  double loss(const PriorState& state, const LossTarget& target,
              PriorState& gradient) const override {
    const LogRanges& ranges = modes_.ranges();
    const int pixels = modes_.computed_pixels();
    const float share = target.share / (static_cast<float>(pixels) *
                                        static_cast<float>(ranges.rows() * ranges.columns()));
    const Tensor& output = state.output();
    Tensor& d_output = gradient.output();
    double loss = 0.0;
    for (int row = 0; row < ranges.rows(); ++row) {
      for (int pixel = 0; pixel < pixels; ++pixel) {
        const int channel = ranges.computed()[pixel].channel;
        loss += modes_.row_kernels().two_modes_loss(
            {.in =
                 modes_.modes_input(state, pixel, row, output.row(0, row), output.channel_stride()),
             .truth_m = target.truth.row(channel, row),
             .return_share = share,
             .range_share = share * kRangeShare,
             .d_outputs = d_output.row(pixel, row),
             .d_group_stride = pixels * d_output.channel_stride()});
      }
    }
    return loss;
  }

  void backward(const Candidates& /*candidates*/, const PriorState& state, PriorState& gradient,
                std::span<float> d_parameters) override {
    gradient.output().fill_borders();
    const BeamParameters* beams = modes_.beams();
    if (beams == nullptr) {
      graph_backward_.backward({&state.values, 1}, {&gradient.values, 1}, d_parameters);
      return;
    }
    std::vector<float> of_graph(elements(prior_.graph().parameter_shapes()), 0.0F);
    graph_backward_.backward({&state.values, 1}, {&gradient.values, 1}, of_graph);
    beams->add_gradient(of_graph, d_parameters);
  }

 private:
  const TwoModesPrior& modes_;
};

}  // namespace

std::shared_ptr<PriorBackward> backward_of(Prior& prior) {
  if (auto* plain = dynamic_cast<PlainPrior*>(&prior)) {
    return std::make_shared<PlainBackward>(*plain);
  }
  if (auto* u_shaped = dynamic_cast<UShapedPrior*>(&prior)) {
    return std::make_shared<UShapedBackward>(*u_shaped);
  }
  if (auto* modes = dynamic_cast<TwoModesPrior*>(&prior)) {
    return std::make_shared<TwoModesBackward>(*modes);
  }
  if (auto* own = dynamic_cast<PriorBackward*>(&prior)) {
    return {std::shared_ptr<PriorBackward>(), own};
  }
  throw Error("training: a prior without gradients, expected one that implements PriorBackward");
}

void PriorBackward::put_truth(const RangeImage& truth_m, float range_scale_m, Tensor& tiles) const {
  RangeImage scaled = truth_m;
  for (float& range : scaled.range_m) range /= range_scale_m;
  to_tiles(scaled.range_m.data(), prior_.tile(), tiles);
}

double PriorBackward::loss(const PriorState& state, const LossTarget& target,
                           PriorState& gradient) const {
  return l1_loss(state.z, target.truth, prior_.tile(), target.restored_rows, target.share,
                 gradient.z);
}

double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile,
               std::optional<RowSelection> restored_rows, float share, Tensor& d_z) {
  const double pixels = static_cast<double>(tile.pixels()) * z.rows() * z.columns();
  const auto weight = static_cast<float>(share / pixels);
  double sum = 0.0;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    for (int row = 0; row < z.rows(); ++row) {
      float* gradient = d_z.row(channel, row);
      if (restored_rows && measured(tile, *restored_rows, channel, row)) {
        for (int x = 0; x < z.columns(); ++x) gradient[x] = 0.0F;
        continue;
      }
      const float* z_row = z.row(channel, row);
      const float* truth_row = truth.row(channel, row);
      float row_sum = 0.0F;
#pragma omp simd reduction(+ : row_sum)
      for (int x = 0; x < z.columns(); ++x) {
        const float difference = z_row[x] - truth_row[x];
        row_sum += std::fabs(difference);
        gradient[x] = difference > 0.0F ? weight : (difference < 0.0F ? -weight : 0.0F);
      }
      sum += row_sum;
    }
  }
  return sum / pixels;
}

void select_backward(const CandidatesOf& candidates, const Tensor& h, TileSize tile,
                     InstructionSet instruction_set, int first_row, const Tensor& weights,
                     const Tensor& d_z, Tensor& d_scores, Tensor& d_h) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set);
  const int pixels = tile.pixels();
  for (int y = 0; y < d_scores.rows(); ++y) {
    const int row = first_row + y;
    for (int channel = 0; channel < pixels; ++channel) {
      const CandidateRows beside = candidates(channel, row);
      kernels.select_gradient({.gain = kSelectionGain,
                               .weights = weights.row(channel, row),
                               .weight_stride = pixels * weights.channel_stride(),
                               .above = beside.above,
                               .below = beside.below,
                               .here = h.row(channel, row),
                               .d_z = d_z.row(channel, row),
                               .d_scores = d_scores.row(channel, y),
                               .d_score_stride = pixels * d_scores.channel_stride(),
                               .d_here = d_h.row(channel, row),
                               .columns = d_z.columns()});
      for (int group = 0; group < kSelectionGroups; ++group) {
        d_scores.fill_border(channel + group * pixels, y);
      }
    }
  }
}

}  // namespace hqslam::nn
