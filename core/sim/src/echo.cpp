#include "echo.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace hqslam::sim {

namespace {

/// Echoes closer together than this cannot be told apart (a pulse of 5 ns).
constexpr double kPulseLength_m = 0.75;

double signal_of(double reflectivity, double cos_incidence, double range_m, double max_range_m) {
  const double nearness = max_range_m / std::max(range_m, 0.1);
  return reflectivity / 0.8 * std::sqrt(std::max(cos_incidence, 0.02)) * nearness * nearness;
}

/// A window: curtained by its shade, or a room of a depth that the shade decides.
std::optional<Echo> echo_of_window(const RayHit& hit, double max_range_m,
                                   std::uint64_t random_bits) {
  constexpr double kMirrorCosine = 0.995;
  if (hit.cos_incidence > kMirrorCosine) {
    return Echo{hit.range_m, signal_of(0.8, 1.0, hit.range_m, max_range_m)};
  }
  const double draw = uniform_of(scrambled(hit.surface.shade));
  if (draw < 0.5) {
    const double range_m = hit.range_m + 0.12 / std::max(hit.cos_incidence, 0.2);
    return Echo{range_m, signal_of(0.25, hit.cos_incidence, range_m, max_range_m)};
  }
  if (uniform_of(scrambled(random_bits)) < 0.6) return std::nullopt;
  const double depth_m = 1.0 + 6.0 * (draw - 0.5) + 0.8 * uniform_of(scrambled(~random_bits));
  const double range_m = hit.range_m + depth_m / std::max(hit.cos_incidence, 0.4);
  return Echo{range_m, signal_of(0.15, hit.cos_incidence, range_m, max_range_m)};
}

std::optional<Echo> echo_of_car_window(const RayHit& hit, double max_range_m,
                                       std::uint64_t random_bits) {
  const double draw = uniform_of(scrambled(random_bits));
  if (draw < 0.65) return std::nullopt;
  if (draw < 0.8) {
    return Echo{hit.range_m,
                signal_of(reflectivity(hit.surface), hit.cos_incidence, hit.range_m, max_range_m)};
  }
  const double range_m = hit.range_m + 0.4 + 0.6 * uniform_of(scrambled(~random_bits));
  return Echo{range_m, signal_of(0.1, hit.cos_incidence, range_m, max_range_m)};
}

}  // namespace

std::optional<Echo> echo_of(const RayHit& hit, double max_range_m, std::uint64_t random_bits) {
  if (hit.surface.material == Material::kGlass) {
    return echo_of_window(hit, max_range_m, random_bits);
  }
  if (hit.surface.material == Material::kCarGlass) {
    return echo_of_car_window(hit, max_range_m, random_bits);
  }
  return Echo{hit.range_m,
              signal_of(reflectivity(hit.surface), hit.cos_incidence, hit.range_m, max_range_m)};
}

void Footprint::add(const Echo& echo, double weight) {
  echoes[static_cast<std::size_t>(count)] = echo;
  weights[static_cast<std::size_t>(count)] = weight;
  ++count;
}

std::optional<Echo> reported_echo(const Footprint& footprint) {
  std::optional<Echo> best;
  double all_weights = 0.0;
  for (int k = 0; k < footprint.count; ++k) {
    all_weights += footprint.weights[static_cast<std::size_t>(k)];
  }
  for (int k = 0; k < footprint.count; ++k) {
    const double from_m = footprint.echoes[static_cast<std::size_t>(k)].range_m;
    double power = 0.0;
    double power_range = 0.0;
    for (int other = 0; other < footprint.count; ++other) {
      const Echo& echo = footprint.echoes[static_cast<std::size_t>(other)];
      if (echo.range_m < from_m || echo.range_m > from_m + kPulseLength_m) continue;
      const double share = echo.signal * footprint.weights[static_cast<std::size_t>(other)];
      power += share;
      power_range += share * echo.range_m;
    }
    if (power > 0.0 && (!best || power / all_weights > best->signal)) {
      best = Echo{power_range / power, power / all_weights};
    }
  }
  return best;
}

float detected_range_m(const Echo& echo, double min_range_m, double max_range_m,
                       std::uint64_t random_bits) {
  const double cube = echo.signal * echo.signal * echo.signal;
  const double probability = 0.997 * cube / (1.0 + cube);
  if (uniform_of(scrambled(random_bits)) >= probability) return 0.0F;
  const double deviation_m = 0.008 + 0.008 / std::sqrt(std::max(echo.signal, 0.25));
  const double range_m = echo.range_m + deviation_m * normal_of(scrambled(~random_bits));
  if (range_m < min_range_m || range_m > max_range_m) return 0.0F;
  return static_cast<float>(std::round(range_m * 1000.0) / 1000.0);
}

}  // namespace hqslam::sim
