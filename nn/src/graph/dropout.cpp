#include "dropout.h"

#include "../random.h"

namespace hqslam::nn {
namespace {

float kept_scale(float share) { return 1.0F / (1.0F - share); }

/// A number from 0 to below 1 for each place, so that it does not matter who asks first.
float unit_random(std::uint64_t seed, std::uint64_t place) {
  Random random(seed + 0x9E3779B97F4A7C15ULL * place);
  return static_cast<float>(random.bits() >> 40) / static_cast<float>(1 << 24);
}

}  // namespace

void drop_out(std::uint64_t seed, float share, Tensor& values) {
#pragma omp for schedule(static)
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      float* row = values.row(channel, y);
      const auto first = static_cast<std::uint64_t>(channel * values.rows() + y) * values.columns();
      for (int x = 0; x < values.columns(); ++x) {
        row[x] = unit_random(seed, first + x) < share ? 0.0F : kept_scale(share) * row[x];
      }
      values.fill_border(channel, y);
    }
  }
}

void drop_out_backward(float share, const Tensor& values, Tensor& gradient) {
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      const float* value = values.row(channel, y);
      float* d = gradient.row(channel, y);
      for (int x = 0; x < values.columns(); ++x) {
        d[x] = value[x] == 0.0F ? 0.0F : kept_scale(share) * d[x];
      }
      gradient.fill_border(channel, y);
    }
  }
}

}  // namespace hqslam::nn
