#include "bias.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "row_kernels.h"

namespace hqslam::nn::kernels {

namespace {

/// In 16 sums side by side: one alone would wait for each addition.
float sum_of(const float* values, int count) {
  constexpr int kSums = 16;
  float sums[kSums] = {};
  int first = 0;
  for (; first + kSums <= count; first += kSums) {
#pragma omp simd
    for (int i = 0; i < kSums; ++i) sums[i] += values[first + i];
  }
  for (; first < count; ++first) sums[0] += values[first];
  float sum = 0.0F;
  for (const float part : sums) sum += part;
  return sum;
}

}  // namespace

std::vector<float> padded_bias(std::span<const float> bias, int channels) {
  if (!bias.empty() && static_cast<int>(bias.size()) != channels) {
    throw Error(
        fmt::format("convolution: {} bias values, expected {} or none", bias.size(), channels));
  }
  std::vector<float> padded(bias.begin(), bias.end());
  padded.resize((channels + kOutputBlock - 1) / kOutputBlock * kOutputBlock);
  return padded;
}

void add_bias_gradient(const Tensor& d_output, std::span<float> d_bias) {
  if (d_bias.empty()) return;
  for (int channel = 0; channel < d_output.channels(); ++channel) {
    for (int y = 0; y < d_output.rows(); ++y) {
      const float* values = d_output.row(channel, y);
      d_bias[channel] += sum_of(values, d_output.columns());
    }
  }
}

}  // namespace hqslam::nn::kernels
