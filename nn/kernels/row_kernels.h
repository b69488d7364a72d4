#pragma once

#include <cstdint>

#include "hqslam/nn/instruction_set.h"

// The loops in which the engine spends its time, compiled once per instruction set. Raw
// pointers only: the wide versions must not share an inline function (Eigen's, say) with code that
// is compiled for the baseline.
namespace hqslam::nn::kernels {

/// Output channels are computed in blocks of this many; packed weights are padded to it.
inline constexpr int kOutputBlock = 8;
/// Gradients of weights are summed for this many narrow channels at a time, padded to it.
inline constexpr int kGradientBlock = 8;
static_assert(kOutputBlock == kGradientBlock);
/// The number of channels padded to whole blocks. (static: see above)
static constexpr int whole_blocks(int channels) {
  return (channels + kOutputBlock - 1) / kOutputBlock * kOutputBlock;
}

/// One row of a convolution as a sum over taps (input channel, kernel row, kernel column):
///   y[o][x]      = bias[o] + sum_t weights[o / 8][t][o % 8] * input[tap_offset[t] + x]
///   output[o][x] = a(y[o][x] + skip[o][x]),  a(v) = max(v, negative_slope * v)
/// for begin <= x < end, rounded up to whole vectors of 16. negative_slope: 1 linear, 0 ReLU.
/// With `activated`, the gradient of what such an a made: a(v) = v where activated > 0, else
/// negative_slope * v.
struct AccumulateRow {
  const float* input = nullptr;
  const std::int64_t* tap_offset = nullptr;
  int taps = 0;
  const float* weights = nullptr;
  const float* bias = nullptr;  ///< padded to whole blocks; nullptr: zero
  int output_channels = 0;
  float* output = nullptr;
  std::int64_t output_channel_stride = 0;
  const float* skip = nullptr;  ///< nullptr: none
  std::int64_t skip_channel_stride = 0;
  const float* activated = nullptr;  ///< nullptr: none
  std::int64_t activated_channel_stride = 0;
  float negative_slope = 1.0F;
  int begin = 0;
  int end = 0;
};

/// The gradient of the weights from some rows:
///   gradient[t][a] += sum_{y, x} narrow[a][y][x] * wide[tap_offset[t] + y wide_row_stride + x]
/// for y < rows and x < columns. Both may be read in whole vectors of 16.
struct CorrelateRows {
  const float* narrow = nullptr;
  std::int64_t narrow_channel_stride = 0;
  std::int64_t narrow_row_stride = 0;
  int narrow_channels = 0;
  const float* wide = nullptr;
  std::int64_t wide_row_stride = 0;
  const std::int64_t* tap_offset = nullptr;
  int taps = 0;
  int rows = 0;
  int columns = 0;
  float* gradient = nullptr;  ///< taps x narrow channels padded to kGradientBlock
};

/// The end of the U-shaped denoiser for one row of pixels (hqs/u_shaped_prior.h has the formula).
/// Groups of scores, `group_stride` apart: above, below, here, nothing, the correction. In: scores,
/// out the softmax of gain times the scores over the four candidates.
struct SelectRow {
  float gain = 1.0F;
  float* scores = nullptr;
  std::int64_t group_stride = 0;
  const float* above = nullptr;
  const float* below = nullptr;
  const float* here = nullptr;
  float* z = nullptr;
  int columns = 0;  ///< rounded up to whole vectors of 16
};

/// Its gradient.
struct SelectGradientRow {
  float gain = 1.0F;
  const float* weights = nullptr;  ///< the softmax, in groups as above
  std::int64_t weight_stride = 0;
  const float* above = nullptr;
  const float* below = nullptr;
  const float* here = nullptr;
  const float* d_z = nullptr;
  float* d_scores = nullptr;  ///< in groups as above
  std::int64_t d_score_stride = 0;
  float* d_here = nullptr;  ///< may be d_z
  int columns = 0;          ///< rounded up to whole vectors of 16
};

/// The start of the two-mode network, a row of interpolated logarithms of ranges:
///   y = -ln(weight_above / r_above + weight_below / r_below)
struct InterpolateRow {
  const float* inverse_above = nullptr;  ///< 1 / m
  const float* inverse_below = nullptr;
  float weight_above = 0.5F;
  float weight_below = 0.5F;
  float* log_range = nullptr;
  int columns = 0;  ///< rounded up to whole vectors of 16
};

/// One row of measured ranges made ready for the two-mode network. A range that is not above 0 or
/// is not finite is no return: its place takes the range of the filled row above.
struct MeasuredRow {
  const float* range_m = nullptr;
  const float* log_range_above = nullptr;
  const float* inverse_above = nullptr;
  float* log_range = nullptr;
  float* inverse = nullptr;
  float* valid = nullptr;  ///< 1 a return, 0 none
  int columns = 0;         ///< rounded up to whole vectors of 16
};

/// The seven outputs per pixel of the two-mode network, nine with a memory, and what they stand on;
/// two_modes.h has the formulas. Output g of a pixel's row begins at outputs + g group_stride.
struct TwoModesInput {
  const float* outputs = nullptr;
  std::int64_t group_stride = 0;
  const float* above = nullptr;  ///< ln of the measured range above
  const float* below = nullptr;
  const float* middle = nullptr;  ///< ln of the range so far
  /// M minus the start, and W^2 / (W^2 + 1); null: nothing can be recalled, and two outputs fewer.
  const float* recalled_step = nullptr;
  const float* recalled_share = nullptr;
  int columns = 0;  ///< all arrays hold them rounded up to whole vectors of 16
};

/// The two modes of a row of pixels from the outputs.
struct TwoModesRow {
  TwoModesInput in;
  float tolerance_m = 0.5F;
  float confidence_exponent = 1.0F;
  float* log_range = nullptr;    ///< the chosen mode
  float* probability = nullptr;  ///< of a return
  float* range_m = nullptr;      ///< nullptr: not wanted; neither is the next then
  float* confidence = nullptr;
  float* mode_1 = nullptr;  ///< ln of the range; nullptr: not wanted; neither are the next then
  float* mode_2 = nullptr;
  float* weight_1 = nullptr;
  float* scale = nullptr;
};

/// The loss of a row and its gradient.
struct TwoModesLossRow {
  TwoModesInput in;
  const float* truth_m = nullptr;  ///< 0: no return; below 0: two_modes.h
  float return_share = 1.0F;       ///< weight of the cross-entropy of each pixel
  float range_share = 1.0F;        ///< weight of the likelihood of each pixel with a return
  float* d_outputs = nullptr;      ///< as outputs, d_group_stride apart
  std::int64_t d_group_stride = 0;
};

/// Winograd's transform of one channel of a row of tiles (winograd_convolution.h has the formulas).
/// Value (i, j) of tile t goes to transformed[(4 i + j) place_stride + t].
struct WinogradInputRow {
  const float* input[4] = {};  ///< rows, each from the first tile's first column on
  int tiles = 0;               ///< whole vectors of 16; 32 columns and two more are read for each
  float* transformed = nullptr;
  std::int64_t place_stride = 0;
};
/// Transforms products back to one channel of the two rows of a row of tiles, ended as
/// AccumulateRow ends.
struct WinogradOutputRow {
  const float* products = nullptr;  ///< as `transformed`
  std::int64_t place_stride = 0;
  int tiles = 0;  ///< whole vectors of 16
  float bias = 0.0F;
  const float* skip[2] = {};       ///< nullptr: none
  const float* activated[2] = {};  ///< nullptr: none
  float negative_slope = 1.0F;
  float* output[2] = {};  ///< the second may be nullptr: not wanted
};

/// One channel of the gradient of those two rows to the 16 values of each tile.
struct WinogradGradientRow {
  const float* d_output[2] = {};  ///< the second may be nullptr: zero
  int tiles = 0;                  ///< whole vectors of 16
  float* transformed = nullptr;
  std::int64_t place_stride = 0;
};

/// A row of every second column, and of those between them, from or into one with all columns.
struct SplitRow {
  const float* input = nullptr;  ///< 2 columns, in whole vectors of 16
  float* even = nullptr;
  float* odd = nullptr;
  int columns = 0;  ///< of each half, rounded up to whole vectors of 16
};
/// output = a(all columns + skip), a as in AccumulateRow.
struct MergeRow {
  const float* even = nullptr;
  const float* odd = nullptr;
  const float* skip = nullptr;       ///< nullptr: none
  const float* activated = nullptr;  ///< nullptr: none
  float negative_slope = 1.0F;
  float* output = nullptr;
  int columns = 0;  ///< of each half, rounded up to whole vectors of 16
};

/// Points of the world in the frame of a sensor that moves while its head turns:
///   p(h) = R(h) (p_world - t(h)),  h the head's place in its turn, -1 its begin, 1 its end
/// R and t are cubics in h: term k of element e, of R row by row and then of t, is motion[e][k].
/// The head measures a point at column head_offset - turn, and begins at first_column; iterated
/// from the middle of the turn twice, which converges.
struct SeePoints {
  const float* x_m = nullptr;  ///< world
  const float* y_m = nullptr;
  const float* z_m = nullptr;
  const float* head_offset = nullptr;
  const float (*motion)[4] = nullptr;
  float columns = 0.0F;       ///< of a whole turn
  float first_column = 0.0F;  ///< within half a turn from 0
  float* range_m = nullptr;
  float* sine = nullptr;  ///< of the elevation
  float* turn = nullptr;  ///< the azimuth, counter-clockwise from ahead, in columns
  int count = 0;          ///< rounded up to whole vectors of 16
};

struct RowKernels {
  void (*accumulate)(const AccumulateRow&);
  void (*correlate)(const CorrelateRows&);
  void (*winograd_input)(const WinogradInputRow&);
  void (*winograd_output)(const WinogradOutputRow&);
  void (*winograd_gradient)(const WinogradGradientRow&);
  void (*split)(const SplitRow&);
  void (*merge)(const MergeRow&);
  void (*select)(const SelectRow&);
  void (*select_gradient)(const SelectGradientRow&);
  void (*fill_measured)(const MeasuredRow&);
  void (*interpolate)(const InterpolateRow&);
  void (*two_modes)(const TwoModesRow&);
  /// Returns the row's share of the loss: of the columns alone, though vectors reach beyond them.
  double (*two_modes_loss)(const TwoModesLossRow&);
  void (*see_points)(const SeePoints&);
};

/// The kernels of an instruction set that this processor has.
const RowKernels& row_kernels(InstructionSet instruction_set);

// One per translation unit.
extern const RowKernels kPortableKernels;
#ifdef HQSLAM_X86_KERNELS
extern const RowKernels kAvx2Kernels;
extern const RowKernels kAvx512Kernels;
#endif

}  // namespace hqslam::nn::kernels
