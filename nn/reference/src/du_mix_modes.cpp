#include <algorithm>
#include <cmath>

#include "du_mix.h"

namespace hqslam::nn::reference {
namespace {

double logistic(double v) { return 1.0 / (1.0 + std::exp(-v)); }

/// The share of a Laplace distribution of scale 1 around 0 below v.
double laplace_below(double v) {
  const double tail = 0.5 * std::exp(-std::fabs(v));
  return v > 0.0 ? 1.0 - tail : tail;
}

/// H with W^2 scaled by an output o of the prior.
double drawn_to_recalled(const ModesInput& in, std::span<const double> outputs, std::size_t o) {
  if (in.recalled_share == 0.0) return in.h;
  const double scaled = in.recalled_share / (1.0 - in.recalled_share) *
                        std::exp(4.0 * std::clamp(outputs[o], -2.0, 2.0));
  return in.start + scaled / (scaled + 1.0) * (in.recalled - in.start);
}

}  // namespace

Modes modes_of(const ModesInput& in, std::span<const double> o) {
  const double first = drawn_to_recalled(in, o, 7);
  const double second = drawn_to_recalled(in, o, 8);
  return {.mode_1 = first + logistic(4.0 * o[0]) * (in.above - first) + o[1],
          .mode_2 = second + logistic(4.0 * o[2]) * (in.below - second) + o[3],
          .weight_1 = logistic(4.0 * o[4]),
          .scale = std::exp(-3.5 + 4.0 * std::clamp(o[5], -0.5, 1.0)),
          .probability = logistic(4.0 * o[6])};
}

double Modes::confidence(double tolerance_m, double exponent) const {
  const double range_m = std::exp(std::clamp(chosen(), -5.0, 9.0));
  const double farther = std::log(1.0 + tolerance_m / range_m) / scale;
  const double nearer = -std::log(std::max(1.0 - tolerance_m / range_m, 1e-6)) / scale;
  const double other = weight_1 >= 0.5 ? mode_2 : mode_1;
  const double gap = (other - chosen()) / scale;
  const double weight = weight_1 >= 0.5 ? weight_1 : 1.0 - weight_1;
  const double of_chosen = laplace_below(farther) - laplace_below(-nearer);
  const double of_other = laplace_below(farther - gap) - laplace_below(-nearer - gap);
  return std::pow(probability * (weight * of_chosen + (1.0 - weight) * of_other), exponent);
}

}  // namespace hqslam::nn::reference
