#pragma once

namespace hqslam::nn {

/// The result of the two-mode network for each computed pixel. With y the natural logarithm of a
/// range in metres, s(v) = 1 / (1 + e^-v), and seven outputs o of the convolutions:
///   y1 = s(4 o0) y_above + (1 - s(4 o0)) y_middle + o1     the mode on the side of the row above
///   y2 = s(4 o2) y_below + (1 - s(4 o2)) y_middle + o3     the mode on the side of the row below
///   w  = s(4 o4)                                           probability of the first
///   ln b = -3.5 + 4 clamp(o5, -1/2, 1)                     the scale of both
///   p  = s(4 o6)                                           probability of a return
/// With a memory two more outputs weigh what is recalled for each mode, by scaling
/// its W^2: y_middle, which is start + W^2 / (W^2 + 1) (M - start), becomes for mode i
///   start + g (M - start),  g = W^2 e / (W^2 e + 1),  e = exp(4 clamp(o_i, -2, 2)),  i = 7, 8
/// so that a range, where there is one, is distributed as w Laplace(y1, b) + (1 - w) Laplace(y2,
/// b). At a depth jump the truth is one surface or the other, never the mean: two modes and a hard
/// choice can express that, one number cannot.
///
/// Result: the mode with the larger weight; its confidence, the probability that there is a return
/// and that it lies within a tolerance of that range: p times the mass of both modes there, to the
/// power of NetworkDescription::confidence_exponent.
///
/// Loss of a pixel: the cross-entropy of p and, where there is a return, a share of
///   -ln(w/b e^(-|y - y1|/b) + (1 - w)/b e^(-|y - y2|/b)).
///
/// Where other scans measured a surface the truth is minus its range: the likelihood of the range
/// counts, but not the cross-entropy, because it is unknown whether this beam would return.
/// kLeastTruth_m and below: nothing is known, nothing counts.
///
/// An addition to the paper, which has one range per pixel and an L1 loss on it.
enum class TwoModesOutput {
  kShareAbove,
  kCorrectionAbove,
  kShareBelow,
  kCorrectionBelow,
  kWeight,
  kScale,
  kReturn,
  kRecallAbove,
  kRecallBelow,
};
/// The number of outputs of each computed pixel.
inline constexpr int two_modes_outputs(bool scan_memory) { return scan_memory ? 9 : 7; }
inline constexpr float kLargestRecall = 2.0F;  ///< the clamp of the last two

/// An optimiser of AdamW's kind moves every weight by the same step; logits must become larger
/// than logarithms of ranges before a choice is clear.
inline constexpr float kTwoModesGain = 4.0F;
inline constexpr float kMiddleLogScale = -3.5F;
inline constexpr float kLowestScale = -0.5F;
inline constexpr float kHighestScale = 1.0F;

inline constexpr float kLeastTruth_m = -1e6F;

}  // namespace hqslam::nn
