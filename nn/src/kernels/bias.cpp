#include "bias.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "row_kernels.h"

namespace hqslam::nn::kernels {

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
      float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
      for (int x = 0; x < d_output.columns(); ++x) sum += values[x];
      d_bias[channel] += sum;
    }
  }
}

}  // namespace hqslam::nn::kernels
