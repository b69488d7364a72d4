// The element-wise part of the two-mode network for one row of pixels; included as
// row_kernels_inl.h is. two_modes.h has the formulas.

#include "row_kernels.h"
#include "two_modes.h"
#include "vector_math_inl.h"

namespace hqslam::nn::kernels {
namespace {

void fill_measured(const MeasuredRow& row) {
  constexpr float kFarthest_m =
      1e4F;  // beyond any sensor; infinity and NaN fail the comparison too
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const Vector range_m = load(row.range_m + x);
    const auto there = (range_m > 0.0F) & (range_m < kFarthest_m);
    const Vector safe_m = there ? larger(range_m, Vector{} + 1e-3F) : Vector{} + 1.0F;
    store(row.log_range + x, there ? logarithm(safe_m) : load(row.log_range_above + x));
    store(row.inverse + x, there ? 1.0F / safe_m : load(row.inverse_above + x));
    store(row.valid + x, there ? Vector{} + 1.0F : Vector{});
  }
}

void interpolate(const InterpolateRow& row) {
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const Vector inverse = row.weight_above * load(row.inverse_above + x) +
                           row.weight_below * load(row.inverse_below + x);
    store(row.log_range + x, -logarithm(inverse));
  }
}

/// The mixture of one vector of pixels.
struct Modes {
  Vector share1, share2;  ///< how much of each mode is the measured range
  Vector mode1, mode2;    ///< ln of ranges in metres
  Vector weight1;
  Vector log_scale;
  Vector probability;
  Vector recall1, recall2;  ///< g of each mode; nothing without a memory
  Vector middle1, middle2;
};

/// g of a mode: the share of what is recalled with its W^2 scaled.
inline Vector recall_share(Vector share, Vector output) {
  const Vector bounded =
      smaller(larger(output, Vector{} - kLargestRecall), Vector{} + kLargestRecall);
  const Vector scaled = share * exponential_up_to_10(kTwoModesGain * bounded);
  return scaled / (scaled + 1.0F - share);
}

inline Modes modes_of(const TwoModesInput& in, int x) {
  const auto output = [&](TwoModesOutput group) {
    return load(in.outputs + static_cast<int>(group) * in.group_stride + x);
  };
  Modes m;
  m.middle1 = m.middle2 = load(in.middle + x);
  if (in.recalled_share != nullptr) {
    const Vector share = load(in.recalled_share + x);
    const Vector step = load(in.recalled_step + x);
    m.recall1 = recall_share(share, output(TwoModesOutput::kRecallAbove));
    m.recall2 = recall_share(share, output(TwoModesOutput::kRecallBelow));
    m.middle1 += (m.recall1 - share) * step;
    m.middle2 += (m.recall2 - share) * step;
  }
  m.share1 = logistic(kTwoModesGain * output(TwoModesOutput::kShareAbove));
  m.share2 = logistic(kTwoModesGain * output(TwoModesOutput::kShareBelow));
  m.mode1 = m.middle1 + m.share1 * (load(in.above + x) - m.middle1) +
            output(TwoModesOutput::kCorrectionAbove);
  m.mode2 = m.middle2 + m.share2 * (load(in.below + x) - m.middle2) +
            output(TwoModesOutput::kCorrectionBelow);
  m.weight1 = logistic(kTwoModesGain * output(TwoModesOutput::kWeight));
  const Vector scale = output(TwoModesOutput::kScale);
  m.log_scale = kMiddleLogScale + kTwoModesGain * smaller(larger(scale, Vector{} + kLowestScale),
                                                          Vector{} + kHighestScale);
  m.probability = logistic(kTwoModesGain * output(TwoModesOutput::kReturn));
  return m;
}

/// The share of a Laplace distribution around 0 below v scales.
inline Vector laplace_below(Vector v) {
  const Vector tail = 0.5F * exponential(-magnitude(v));
  return v > 0.0F ? 1.0F - tail : tail;
}

void two_modes(const TwoModesRow& row) {
  for (int x = 0; x < row.in.columns; x += kVectorFloats) {
    const Modes m = modes_of(row.in, x);
    const auto first = m.weight1 >= 0.5F;
    const Vector y = first ? m.mode1 : m.mode2;
    store(row.log_range + x, y);
    store(row.probability + x, m.probability);
    if (row.mode_1 != nullptr) {
      store(row.mode_1 + x, m.mode1);
      store(row.mode_2 + x, m.mode2);
      store(row.weight_1 + x, m.weight1);
      store(row.scale + x, exponential_up_to_10(m.log_scale));
    }
    if (row.range_m == nullptr) continue;
    const Vector bounded = smaller(larger(y, Vector{} - 5.0F), Vector{} + 9.0F);
    const Vector range_m = exponential_up_to_10(bounded);
    const Vector inverse_scale = exponential_up_to_10(-m.log_scale);
    // The tolerance in ln of the range, on both sides, and in scales.
    const Vector part = row.tolerance_m / range_m;
    const Vector farther = logarithm(1.0F + part) * inverse_scale;
    const Vector nearer = -logarithm(larger(1.0F - part, Vector{} + 1e-6F)) * inverse_scale;
    const Vector gap = ((first ? m.mode2 : m.mode1) - y) * inverse_scale;
    const Vector of_chosen = laplace_below(farther) - laplace_below(-nearer);
    const Vector of_other = laplace_below(farther - gap) - laplace_below(-nearer - gap);
    const Vector weight = first ? m.weight1 : 1.0F - m.weight1;
    store(row.range_m + x, range_m);
    const Vector said = m.probability * (weight * of_chosen + (1.0F - weight) * of_other);
    const Vector above_zero = smaller(larger(said, Vector{} + 1e-9F), Vector{} + 1.0F);
    store(row.confidence + x, exponential(row.confidence_exponent * logarithm(above_zero)));
  }
}

/// The mask of the lanes that are columns of the row.
inline double sum_of_columns(Vector terms, int columns) {
  for (int lane = columns; lane < kVectorFloats; ++lane) terms[lane] = 0.0F;
  return static_cast<double>(sum_of(terms));
}

double two_modes_loss(const TwoModesLossRow& row) {
  double loss = 0.0;
  for (int x = 0; x < row.in.columns; x += kVectorFloats) {
    const Modes m = modes_of(row.in, x);
    const Vector truth_m = load(row.truth_m + x);
    const auto there = truth_m > 0.0F;
    const auto ranged = there | ((truth_m < 0.0F) & (truth_m > kLeastTruth_m));
    const Vector y = logarithm(ranged ? magnitude(truth_m) : Vector{} + 1.0F);
    const Vector inverse_scale = exponential_up_to_10(-m.log_scale);
    const Vector off1 = y - m.mode1;
    const Vector off2 = y - m.mode2;
    const Vector far1 = magnitude(off1) * inverse_scale;
    const Vector far2 = magnitude(off2) * inverse_scale;
    // ln(w e^-far1 + (1 - w) e^-far2), the nearer mode's exponential taken out
    const Vector near = smaller(far1, far2);
    const Vector part1 = m.weight1 * exponential(near - far1);
    const Vector part2 = (1.0F - m.weight1) * exponential(near - far2);
    const Vector sum = larger(part1 + part2, Vector{} + 1e-30F);
    const Vector range_share = ranged ? Vector{} + row.range_share : Vector{};
    const Vector return_share = truth_m < 0.0F ? Vector{} : Vector{} + row.return_share;
    const Vector posterior1 = part1 / sum;
    const Vector posterior2 = part2 / sum;
    const Vector valid = there ? Vector{} + 1.0F : Vector{};
    const Vector likely = there ? m.probability : 1.0F - m.probability;
    const Vector terms = range_share * (m.log_scale + near - logarithm(sum)) -
                         return_share * logarithm(larger(likely, Vector{} + 1e-7F));
    loss += sum_of_columns(terms, row.in.columns - x);
    const auto put = [&](TwoModesOutput group, Vector gradient) {
      store(row.d_outputs + static_cast<int>(group) * row.d_group_stride + x, gradient);
    };
    const auto towards = [&](Vector off) {
      const Vector one = Vector{} + 1.0F;
      return off > 0.0F ? -one : (off < 0.0F ? one : Vector{});
    };
    const Vector d_mode1 = range_share * posterior1 * inverse_scale * towards(off1);
    const Vector d_mode2 = range_share * posterior2 * inverse_scale * towards(off2);
    put(TwoModesOutput::kCorrectionAbove, d_mode1);
    put(TwoModesOutput::kCorrectionBelow, d_mode2);
    put(TwoModesOutput::kShareAbove, kTwoModesGain * d_mode1 * m.share1 * (1.0F - m.share1) *
                                         (load(row.in.above + x) - m.middle1));
    put(TwoModesOutput::kShareBelow, kTwoModesGain * d_mode2 * m.share2 * (1.0F - m.share2) *
                                         (load(row.in.below + x) - m.middle2));
    put(TwoModesOutput::kWeight, kTwoModesGain * range_share * (m.weight1 - posterior1));
    const Vector scale =
        load(row.in.outputs + static_cast<int>(TwoModesOutput::kScale) * row.in.group_stride + x);
    const auto free = (scale >= kLowestScale) & (scale <= kHighestScale);
    const Vector d_log_scale = range_share * (1.0F - posterior1 * far1 - posterior2 * far2);
    put(TwoModesOutput::kScale, free ? kTwoModesGain * d_log_scale : Vector{});
    put(TwoModesOutput::kReturn, kTwoModesGain * (return_share * (m.probability - valid)));
    if (row.in.recalled_share == nullptr) continue;
    const Vector step = load(row.in.recalled_step + x);
    const auto put_recall = [&](TwoModesOutput group, Vector d_mode, Vector share, Vector recall) {
      const Vector said =
          magnitude(load(row.in.outputs + static_cast<int>(group) * row.in.group_stride + x));
      const Vector gradient =
          kTwoModesGain * d_mode * (1.0F - share) * step * recall * (1.0F - recall);
      put(group, said < kLargestRecall ? gradient : Vector{});
    };
    put_recall(TwoModesOutput::kRecallAbove, d_mode1, m.share1, m.recall1);
    put_recall(TwoModesOutput::kRecallBelow, d_mode2, m.share2, m.recall2);
  }
  return loss;
}

}  // namespace
}  // namespace hqslam::nn::kernels
