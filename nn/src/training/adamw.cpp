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
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const float g = gradient[i];
    float& m = first_moment[i];
    float& v = second_moment[i];
    m = options.beta1 * m + (1.0F - options.beta1) * g;
    v = options.beta2 * v + (1.0F - options.beta2) * g * g;
    const float decay = decays.empty() || decays[i] != 0 ? options.weight_decay : 0.0F;
    parameters[i] -= learning_rate * (decay * parameters[i] +
                                      m * scale1 / (std::sqrt(v * scale2) + options.epsilon));
  }
}

double clip_norm(double largest_norm, std::span<float> gradient) {
  double sum = 0.0;
  for (const float g : gradient) sum += static_cast<double>(g) * g;
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
