#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/slam/options.h"

namespace hqslam::slam {

namespace {

struct Bounds {
  bool (*holds)(double value);
  std::string_view expected;
};

constexpr Bounds kPositive{[](double value) { return value > 0.0 && std::isfinite(value); },
                           "a positive number"};
constexpr Bounds kTurn{[](double value) { return std::abs(value) <= std::numbers::pi + 1e-3; },
                       "an angle between -pi and pi"};
constexpr Bounds kTilt{[](double value) { return std::abs(value) < std::numbers::pi / 2.0; },
                       "an angle between -pi/2 and pi/2"};
constexpr Bounds kSwitch{[](double value) { return value == 0.0 || value == 1.0; }, "0 or 1"};
/// A cube of the map numbers its voxels with 16 bits; in rooms they are half as large.
constexpr Bounds kMapLeaf{[](double value) { return value >= 0.1 && std::isfinite(value); },
                          "0.1 or more"};
/// Thinning covers a million voxels, so at least 1 km.
constexpr Bounds kLeaf{[](double value) { return value >= 0.001 && std::isfinite(value); },
                       "0.001 or more"};

/// The option in field `Field` of stage `Stage` of SlamOptions.
template <auto Stage, auto Field>
constexpr NamedOption option(std::string_view name, std::string_view meaning,
                             const Bounds& bounds) {
  using Value = std::remove_cvref_t<decltype(SlamOptions().*Stage.*Field)>;
  return {name,
          meaning,
          bounds.expected,
          std::is_integral_v<Value>,
          bounds.holds,
          [](const SlamOptions& options) { return static_cast<double>(options.*Stage.*Field); },
          [](SlamOptions& options, double value) {
            options.*Stage.*Field = static_cast<Value>(value);
          }};
}

#define HQSLAM_OPTION(stage, field, meaning, bounds)                                            \
  option<&SlamOptions::stage, &decltype(SlamOptions::stage)::field>(#stage "." #field, meaning, \
                                                                    bounds)

constexpr std::array kOptions = {
    HQSLAM_OPTION(mounting, roll_rad,
                  "Roll of the sensor: positive raises its left side, pi is upside down", kTurn),
    HQSLAM_OPTION(mounting, pitch_rad, "Pitch of the sensor: positive lowers its front", kTilt),
    HQSLAM_OPTION(
        mounting, estimated,
        "1: correct roll and pitch by up to 30 degrees from the ground of the first scan; "
        "0: only where they are off by more than 5",
        kSwitch),
    HQSLAM_OPTION(mapping, max_iterations, "Searches in the map per scan; LeGO-LOAM: 10",
                  kPositive),
    HQSLAM_OPTION(mapping, min_correspondences,
                  "Smallest number of correspondences of a registered scan", kPositive),
    HQSLAM_OPTION(mapping, planar_leaf_m,
                  "Voxel size of ground and surfaces in the map; in rooms half of it", kMapLeaf),
    HQSLAM_OPTION(mapping, located_planar_leaf_m,
                  "Voxel size of ground and surfaces in a scan that is registered, in rooms half "
                  "of it; LeGO-LOAM: as in the map",
                  kLeaf),
    HQSLAM_OPTION(
        mapping, trusted_residual_m,
        "Distance of a feature from its line or plane at which its weight falls, in later "
        "searches; LeGO-LOAM lowers the weight by 0.09 for each 0.1 m",
        kPositive),
    HQSLAM_OPTION(mapping, max_plane_residual_m,
                  "Largest distance of the five points of a surface from their plane; in rooms a "
                  "quarter of it",
                  kPositive),
    HQSLAM_OPTION(mapping, max_ground_residual_m,
                  "Largest distance of five points of the ground from their plane; LeGO-LOAM: 0.2",
                  kPositive),
    HQSLAM_OPTION(
        mapping, recent_path_m,
        "Length of path whose observations stay in the sliding window; LeGO-LOAM: all of it",
        kPositive)};

#undef HQSLAM_OPTION

constexpr int kMostThreads = 256;

[[noreturn]] void refuse(std::string_view name, double value, std::string_view expected) {
  throw Error("SLAM option {} is {}, expected {}", name, value, expected);
}

void require(bool holds, std::string_view name, double value, std::string_view expected) {
  if (!holds) refuse(name, value, expected);
}

}  // namespace

std::span<const NamedOption> option_table() { return kOptions; }

void set_option(SlamOptions& options, std::string_view name, double value) {
  const auto found = std::ranges::find(kOptions, name, &NamedOption::name);
  if (found == kOptions.end()) {
    throw Error("expected a SLAM option, found {}; hqslam slam-options lists them", name);
  }
  require(found->holds(value), name, value, found->expected);
  const bool is_int = value == std::floor(value) && value <= std::numeric_limits<int>::max();
  require(is_int || !found->is_whole, name, value, "a whole number");
  found->set(options, value);
}

void validate(const SlamOptions& options) {
  require(options.threads >= 0 && options.threads <= kMostThreads, "threads", options.threads,
          "0 to 256");
  for (const NamedOption& option : kOptions) {
    const double value = option.get(options);
    require(option.holds(value), option.name, value, option.expected);
  }
  const MountingOptions& mounting = options.mounting;
  require(std::abs(std::cos(mounting.roll_rad) * std::cos(mounting.pitch_rad)) >= 0.5,
          "mounting.pitch_rad", mounting.pitch_rad,
          "a sensor within 60 degrees of upright or upside down");
}

}  // namespace hqslam::slam
