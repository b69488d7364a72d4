#include <algorithm>

#include "kernels/strided_convolution.h"

// The gradient of the weights.
namespace hqslam::nn::kernels {

void StridedConvolution::add_weight_gradient(const Tensor& narrow, int first_row,
                                             const Tensor& wide, std::span<float> gradient,
                                             ConvolutionScratch& scratch) const {
  const int channels = whole_blocks(shape_.output_channels);
  const int taps = static_cast<int>(gather_offset_.size());
  float* sums = scratch.rows.front().data();
  std::fill_n(sums, static_cast<std::size_t>(channels) * taps, 0.0F);
  // As many rows at a time as a block of channels may have in the first-level cache.
  constexpr int kCachedFloats = 6144;
  const int cached = std::max(1, kCachedFloats / (kGradientBlock * narrow_columns_));
  const int most = shape_.column_stride() == 1 ? cached : std::min(cached, kBlockRows);
  const int parts = (narrow.rows() + most - 1) / most;
  for (int part = 0; part < parts; ++part) {
    const int begin = part * narrow.rows() / parts;
    const int end = (part + 1) * narrow.rows() / parts;
    const GatherRows rows = gather_rows(wide, first_row + begin, first_row + end, scratch);
    kernels_->correlate({.narrow = narrow.row(0, begin),
                         .narrow_channel_stride = narrow.channel_stride(),
                         .narrow_row_stride = narrow.row_stride(),
                         .narrow_channels = shape_.output_channels,
                         .wide = rows.first,
                         .wide_row_stride = rows.row_stride,
                         .tap_offset = gather_offset_.data(),
                         .taps = taps,
                         .rows = end - begin,
                         .columns = narrow_columns_,
                         .gradient = sums});
  }
  for (int a = 0; a < shape_.output_channels; ++a) {
    for (int t = 0; t < taps; ++t) gradient[a * taps + t] += sums[t * channels + a];
  }
}

}  // namespace hqslam::nn::kernels
