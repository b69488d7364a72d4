#include "hqslam/sim/sensor_errors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr std::array<const char*, 3> kNames = {"none", "typical", "bad"};
/// Standard deviations; nothing is farther from 0 than twice that.
constexpr double kAngle_rad = 0.05 * kDegree_rad;
constexpr double kRange_m = 0.015;
constexpr double kBetweenBlocks_rad = 0.3 * kDegree_rad;
constexpr double kGain = 0.05;
constexpr std::uint64_t kGainKey = 1;  ///< gains have bits of their own

double drawn_within_two_sigma(double sigma, Random& random) {
  double value = random.normal();
  while (std::abs(value) > 2.0) value = random.normal();
  return sigma * value;
}

}  // namespace

std::vector<std::string> sensor_errors_names() { return {kNames.begin(), kNames.end()}; }

std::string name_of(SensorErrors errors) { return kNames[static_cast<std::size_t>(errors)]; }

SensorErrors sensor_errors_named(std::string_view name) {
  const auto* found = std::ranges::find(kNames, name);
  if (found == kNames.end()) {
    throw Error("sensor errors '{}': expected one of {}; choose one of them", name,
                fmt::join(kNames, ", "));
  }
  return static_cast<SensorErrors>(found - kNames.begin());
}

BeamErrors draw_beam_errors(SensorErrors errors, int rows, std::uint64_t drive_seed) {
  const auto count = static_cast<std::size_t>(rows);
  const std::vector<double> zeros(count, 0.0);
  BeamErrors beams{zeros, zeros, zeros, std::vector<double>(count, 1.0)};
  if (errors == SensorErrors::kNone) return beams;
  const bool bad = errors == SensorErrors::kBad;
  Random random(seed_of(drive_seed, DrivePart::kErrors));
  const double block_rad = (random.chance(0.5) ? 0.5 : -0.5) * (bad ? kBetweenBlocks_rad : 0.0);
  for (std::size_t row = 0; row < count; ++row) {
    beams.range_m[row] = (bad ? 2.0 : 1.0) * drawn_within_two_sigma(kRange_m, random);
    beams.elevation_rad[row] =
        (2 * row < count ? block_rad : -block_rad) + drawn_within_two_sigma(kAngle_rad, random);
    beams.azimuth_rad[row] = drawn_within_two_sigma(kAngle_rad, random);
  }
  Random gains(seed_of(seed_of(drive_seed, DrivePart::kErrors), kGainKey));
  for (double& gain : beams.intensity_gain) {
    gain += (bad ? 3.0 : 1.0) * drawn_within_two_sigma(kGain, gains);
  }
  return beams;
}

}  // namespace hqslam::sim
