#include "hqslam/nn/training/adamw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hqslam::nn {

void AdamW::step(std::span<const float> gradient, float learning_rate,
                 std::span<const std::uint8_t> decays, std::span<float> parameters) {
  ++steps;
  const auto t = static_cast<double>(steps);
  const auto scale1 = static_cast<float>(1.0 / (1.0 - std::pow(options.beta1, t)));
  const auto scale2 = static_cast<float>(1.0 / (1.0 - std::pow(options.beta2, t)));
  const AdamWOptions o = options;
  float* p = parameters.data();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (decays.empty() || decays[i] != 0) p[i] -= learning_rate * o.weight_decay * p[i];
  }
  float* m = first_moment.data();
  float* v = second_moment.data();
#pragma omp simd
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const float g = gradient[i];
    m[i] = o.beta1 * m[i] + (1.0F - o.beta1) * g;
    v[i] = o.beta2 * v[i] + (1.0F - o.beta2) * g * g;
    p[i] -= learning_rate * (m[i] * scale1 / (std::sqrt(v[i] * scale2) + o.epsilon));
  }
}

double clip_norm(double largest_norm, std::span<float> gradient) {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    sum += static_cast<double>(gradient[i]) * gradient[i];
  }
  const double norm = std::sqrt(sum);
  if (norm > largest_norm) {
    const auto scale = static_cast<float>(largest_norm / norm);
    for (float& g : gradient) g *= scale;
  }
  return norm;
}

float cosine_learning_rate(float highest, std::int64_t warm_up_steps, std::int64_t steps,
                           std::int64_t step) {
  if (step < warm_up_steps) {
    return highest * static_cast<float>(step + 1) / static_cast<float>(warm_up_steps);
  }
  const double part = static_cast<double>(step - warm_up_steps) /
                      static_cast<double>(std::max<std::int64_t>(1, steps - warm_up_steps));
  return static_cast<float>(highest * 0.5 *
                            (1.0 + std::cos(std::numbers::pi * std::min(1.0, part))));
}

}  // namespace hqslam::nn
