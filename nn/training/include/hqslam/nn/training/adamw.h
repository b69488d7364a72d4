#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace hqslam::nn {

/// PyTorch's defaults but for the learning rate, which the schedule gives.
struct AdamWOptions {
  float beta1 = 0.9F;
  float beta2 = 0.999F;
  float epsilon = 1e-8F;
  float weight_decay = 0.01F;
};

/// AdamW (Loshchilov & Hutter, 2019): per parameter p with gradient g at step t, counted from 1,
///   p -= rate weight_decay p
///   m = beta1 m + (1 - beta1) g;  v = beta2 v + (1 - beta2) g^2
///   p -= rate (m / (1 - beta1^t)) / (sqrt(v / (1 - beta2^t)) + epsilon)
struct AdamW {
  AdamWOptions options;
  std::int64_t steps = 0;
  std::vector<float> first_moment;   ///< m
  std::vector<float> second_moment;  ///< v

  AdamW(const AdamWOptions& options_, std::size_t parameters)
      : options(options_), first_moment(parameters), second_moment(parameters) {}
  /// decays: of each parameter, whether weight decay pulls at it; empty: at all of them.
  void step(std::span<const float> gradient, float learning_rate,
            std::span<const std::uint8_t> decays, std::span<float> parameters);
};

/// Scales the gradient so that its Euclidean norm is at most `largest_norm`. Returns the norm
/// before.
double clip_norm(double largest_norm, std::span<float> gradient);

/// Rises linearly from highest / warm_up_steps to highest over warm_up_steps, then falls to 0 on a
/// cosine until `steps`. step counts from 0.
float cosine_learning_rate(float highest, std::int64_t warm_up_steps, std::int64_t steps,
                           std::int64_t step);

}  // namespace hqslam::nn
