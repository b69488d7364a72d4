#include "echo.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "random.h"

namespace hqslam::sim {

namespace {

/// Echoes closer together than this cannot be separated (a pulse of 5 ns).
constexpr double kPulseLength_m = 0.75;
/// Surfaces farther apart leave no mixed pixels.
constexpr double kMixedReach_m = 2.0;

double signal_of(double reflectivity, double cos_incidence, double range_m, double max_range_m) {
  const double nearness = max_range_m / std::max(range_m, 0.1);
  // Roots instead of pow: they are rounded alike on every machine.
  const double quarter = std::sqrt(std::sqrt(std::max(cos_incidence, 0.02)));
  return reflectivity / 0.8 * quarter * std::sqrt(quarter) * nearness * nearness;
}

/// Most pixels of a patch of glass behave alike, a few do not.
bool lost_in_glass(const PixelBits& bits, double share_of_patches) {
  const bool lost_patch = uniform_of(scrambled(bits.patch)) < share_of_patches;
  return uniform_of(scrambled(bits.pixel)) < (lost_patch ? 0.93 : 0.06);
}

/// Shares of windows: those with curtains come first.
constexpr double kCurtained = 0.45;

double window_draw(const RayHit& hit) { return uniform_of(scrambled(hit.surface.shade)); }

double range_through_window_m(const RayHit& hit) {
  if (window_draw(hit) < kCurtained) return hit.range_m + 0.12 / std::max(hit.cos_incidence, 0.2);
  const double depth_m = 1.0 + 6.0 * uniform_of(scrambled(~hit.surface.shade));
  return hit.range_m + depth_m / std::max(hit.cos_incidence, 0.4);
}

double range_to_seats_m(const RayHit& hit) {
  return hit.range_m + (0.3 + 0.4 * uniform_of(scrambled(hit.surface.shade)));
}

/// A window, all of it alike: with curtains, showing the room behind, or swallowing the beam. Its
/// shade decides.
std::optional<Echo> echo_of_window(const RayHit& hit, double max_range_m, const PixelBits& bits) {
  constexpr double kMirrorCosine = 0.995;
  if (hit.cos_incidence > kMirrorCosine) {
    return Echo{hit.range_m, signal_of(0.8, 1.0, hit.range_m, max_range_m)};
  }
  const double draw = window_draw(hit);
  const double range_m = range_through_window_m(hit);
  if (draw < kCurtained) {
    return Echo{range_m, signal_of(0.25, hit.cos_incidence, range_m, max_range_m)};
  }
  if (lost_in_glass(bits, draw < 0.7 ? 0.9 : 0.15)) return std::nullopt;
  return Echo{range_m, signal_of(0.15, hit.cos_incidence, range_m, max_range_m)};
}

std::optional<Echo> echo_of_car_window(const RayHit& hit, double max_range_m,
                                       const PixelBits& bits) {
  const double tint = uniform_of(scrambled(hit.surface.shade));
  if (lost_in_glass(bits, 0.25 + 0.65 * tint)) return std::nullopt;
  // Through the glass to the seats, or off the glass itself.
  const bool seats = uniform_of(scrambled(~bits.patch)) < 0.7;
  const double range_m = seats ? range_to_seats_m(hit) : hit.range_m;
  return Echo{range_m, signal_of(seats ? 0.1 : 0.12, hit.cos_incidence, range_m, max_range_m)};
}

}  // namespace

PulseErrors pulse_errors(SensorErrors errors) {
  if (errors == SensorErrors::kTypical) return {0.25, 0.01, 0.7, 0.1, 0.1};
  if (errors == SensorErrors::kBad) return {0.5, 0.02, 0.5, 0.2, 0.2};
  return {};
}

Echo with_errors(const Echo& echo, double cos_incidence, const PulseErrors& errors) {
  const double cosine = std::max(cos_incidence, 0.01);
  const double tangent = std::sqrt(1.0 - std::min(cosine * cosine, 1.0)) / cosine;
  const double nearer_m =
      std::min(errors.incidence_share * echo.range_m * kHalfDivergence_rad * tangent, 0.2);
  const double later_m = errors.walk_m * (4.0 - echo.signal) / (4.0 + echo.signal);
  return {echo.range_m - nearer_m + later_m, errors.signal_share * echo.signal};
}

bool is_glass(Material material) {
  return material == Material::kGlass || material == Material::kCarGlass;
}

double range_through_glass_m(const RayHit& hit) {
  return hit.surface.material == Material::kCarGlass ? range_to_seats_m(hit)
                                                     : range_through_window_m(hit);
}

std::optional<Echo> echo_of(const RayHit& hit, double max_range_m, const PixelBits& bits) {
  const Surface surface = hit.surface;
  if (surface.material == Material::kGlass) return echo_of_window(hit, max_range_m, bits);
  if (surface.material == Material::kCarGlass) return echo_of_car_window(hit, max_range_m, bits);
  return Echo{hit.range_m,
              signal_of(reflectivity(surface), hit.cos_incidence, hit.range_m, max_range_m)};
}

std::optional<Echo> Footprint::reported_echo(double mixed_share, std::uint64_t random_bits) const {
  const std::span parts(parts_.data(), count_);
  double all_weights = 0.0;
  for (const Part& part : parts) all_weights += part.weight;
  std::optional<Echo> best;
  for (const Part& first : parts) {
    double power = 0.0;
    double power_range = 0.0;
    for (const auto& [echo, weight] : parts) {
      if (echo.range_m < first.echo.range_m || echo.range_m > first.echo.range_m + kPulseLength_m) {
        continue;
      }
      power += echo.signal * weight;
      power_range += echo.signal * weight * echo.range_m;
    }
    if (power > 0.0 && (!best || power / all_weights > best->signal)) {
      best = Echo{power_range / power, power / all_weights};
    }
  }
  Random random(random_bits);
  if (!best || !random.chance(mixed_share)) return best;
  for (const Part& other : parts) {
    const double apart_m = other.echo.range_m - best->range_m;
    if (std::abs(apart_m) <= kPulseLength_m || std::abs(apart_m) > kMixedReach_m) continue;
    best->range_m += apart_m * random.uniform();
    break;
  }
  return best;
}

float detected_range_m(const Echo& echo, double min_range_m, double max_range_m,
                       std::uint64_t random_bits) {
  const double square = echo.signal * echo.signal;
  const double power = square * square * echo.signal;
  const double probability = 0.9985 * power / (1.0 + power);
  if (uniform_of(scrambled(random_bits)) >= probability) return 0.0F;
  const double deviation_m = 0.008 + 0.008 / std::sqrt(std::max(echo.signal, 0.25));
  const double range_m = echo.range_m + deviation_m * normal_of(scrambled(~random_bits));
  if (range_m < min_range_m || range_m > max_range_m) return 0.0F;
  return static_cast<float>(std::round(range_m * 1000.0) / 1000.0);
}

double transmission(double extinction_per_m, double range_m) {
  double left = 1.0 / (1.0 + extinction_per_m * range_m / 8.0);
  for (int doubling = 0; doubling < 4; ++doubling) left *= left;
  return left;
}

std::uint8_t intensity_of(const Echo& echo, double max_range_m) {
  const double nearness = max_range_m / std::max(echo.range_m, 0.1);
  const double reflectivity = 0.8 * echo.signal / (nearness * nearness);
  const double intensity = reflectivity < 1.0 ? 100.0 * reflectivity : 69.0 + 31.0 * reflectivity;
  return static_cast<std::uint8_t>(std::lround(std::min(intensity, 255.0)));
}

Return disturbed_return(Return measured, const SensingConditions& conditions,
                        const SensorModel& sensor, std::uint64_t random_bits) {
  constexpr std::uint8_t kDrops = 2;
  if (conditions == SensingConditions{}) return measured;
  Random random(random_bits);
  double disturbed_m = measured.range_m;
  const bool meets_drops = random.chance(conditions.airborne_share);
  const double nearness = random.uniform();
  const double drops_m = sensor.min_range_m + 12.0 * nearness * nearness;
  if (meets_drops && (measured.range_m == 0.0F || drops_m < disturbed_m)) {
    disturbed_m = drops_m;
    measured.intensity = kDrops;
  }
  const bool lost = random.chance(conditions.dropout_share);
  if (lost || disturbed_m == 0.0) return {};
  disturbed_m += conditions.extra_range_noise_m * random.normal();
  if (disturbed_m < sensor.min_range_m || disturbed_m > sensor.max_range_m) return {};
  return {static_cast<float>(std::round(disturbed_m * 1000.0) / 1000.0), measured.intensity};
}

}  // namespace hqslam::sim
