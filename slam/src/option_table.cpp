
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
constexpr Bounds kNotNegative{[](double value) { return value >= 0.0 && std::isfinite(value); },
                              "0 or a positive number"};
constexpr Bounds kAcute{[](double value) { return value > 0.0 && value < std::numbers::pi / 2.0; },
                        "an angle between 0 and pi/2"};
constexpr Bounds kShare{[](double value) { return value >= 0.0 && value < 1.0; },
                        "a share from 0 to 1"};
/// A row of 16384 pixels times its sections is still an int.
constexpr Bounds kSections{[](double value) { return value >= 1.0 && value <= 1000.0; },
                           "1 to 1000"};
constexpr Bounds kTurn{[](double value) { return std::abs(value) <= std::numbers::pi + 1e-3; },
                       "an angle between -pi and pi"};
constexpr Bounds kTilt{[](double value) { return std::abs(value) < std::numbers::pi / 2.0; },
                       "an angle between -pi/2 and pi/2"};
constexpr Bounds kSwitch{[](double value) { return value == 0.0 || value == 1.0; }, "0 or 1"};
/// Thinning reaches a million voxels far: 1 km.
constexpr Bounds kLeaf{[](double value) { return value >= 0.001 && std::isfinite(value); },
                       "0.001 or more"};

/// The option in field `Field` of part `Part` of SlamOptions.
template <auto Part, auto Field>
constexpr NamedOption option(std::string_view name, std::string_view meaning,
                             const Bounds& bounds) {
  using Value = std::remove_cvref_t<decltype(SlamOptions().*Part.*Field)>;
  return {
      name,
      meaning,
      bounds.expected,
      std::is_integral_v<Value>,
      bounds.holds,
      [](const SlamOptions& options) { return static_cast<double>(options.*Part.*Field); },
      [](SlamOptions& options, double value) { options.*Part.*Field = static_cast<Value>(value); }};
}

#define HQSLAM_OPTION(part, field, meaning, bounds) \
  option<&SlamOptions::part, &decltype(SlamOptions::part)::field>(#part "." #field, meaning, bounds)

constexpr std::array kOptions = {
    HQSLAM_OPTION(
        mounting, roll_rad,
        "how the sensor leans: its left side is up by so much, at pi it hangs upside down", kTurn),
    HQSLAM_OPTION(mounting, pitch_rad, "and its front down by so much", kTilt),
    HQSLAM_OPTION(mounting, estimated,
                  "1: corrected by up to 30 degrees from the ground of the first scan", kSwitch),
    HQSLAM_OPTION(ground, max_slope_rad, "steepest rise from row to row that is ground", kAcute),
    HQSLAM_OPTION(segmentation, min_angle_rad,
                  "neighbours belong together if the line through them makes at least this angle "
                  "with the beam",
                  kAcute),
    HQSLAM_OPTION(segmentation, min_pixels, "a cluster of so many pixels is kept,", kPositive),
    HQSLAM_OPTION(segmentation, min_pixels_tall, "or of so many", kPositive),
    HQSLAM_OPTION(segmentation, min_rows_tall, "over so many rows", kPositive),
    HQSLAM_OPTION(features, sections, "equal parts of a row from which features are drawn",
                  kSections),
    HQSLAM_OPTION(features, sharp_edges_per_section, "matched from scan to scan", kPositive),
    HQSLAM_OPTION(features, edges_per_section, "matched against, and put into the map", kPositive),
    HQSLAM_OPTION(features, flat_points_per_section, "of the ground, matched from scan to scan",
                  kPositive),
    HQSLAM_OPTION(features, min_edge_smoothness_m,
                  "smoothness is |sum of 10 neighbours' ranges - 10 range|: a flat point has less, "
                  "an edge more than this",
                  kNotNegative),
    HQSLAM_OPTION(features, min_edge_smoothness_per_range,
                  "and more than this times its range; LeGO-LOAM has none", kNotNegative),
    HQSLAM_OPTION(features, planar_leaf_m, "surface points: one per voxel", kLeaf),
    HQSLAM_OPTION(features, max_post_width_m, "of what stands alone; LeGO-LOAM has no posts",
                  kNotNegative),
    HQSLAM_OPTION(odometry, max_iterations, "searches per scan; LeGO-LOAM: 25, of shorter steps",
                  kPositive),
    HQSLAM_OPTION(odometry, min_edges, "fewer are no scan to follow", kPositive),
    HQSLAM_OPTION(odometry, min_planar, "nor are fewer, without edges", kPositive),
    HQSLAM_OPTION(odometry, min_correspondences, "of a step", kPositive),
    HQSLAM_OPTION(odometry, max_distance_m, "from a feature to its neighbours in the last scan",
                  kPositive),
    HQSLAM_OPTION(odometry, converged_rotation_rad, "a step below this is the last", kNotNegative),
    HQSLAM_OPTION(odometry, converged_translation_m,
                  "the same; LeGO-LOAM: 0.001; mapping refines it", kNotNegative),
    HQSLAM_OPTION(mapping, max_iterations, "searches in the map per scan", kPositive),
    HQSLAM_OPTION(mapping, min_correspondences, "fewer register no scan", kPositive),
    HQSLAM_OPTION(mapping, min_matched_share,
                  "a scan of which less fits the map is not of this place; measured: streets 0.47 "
                  "and more, noise 0.2; LeGO-LOAM has none",
                  kShare),
    HQSLAM_OPTION(mapping, edge_leaf_m, "edges of the map: one per voxel", kLeaf),
    HQSLAM_OPTION(mapping, planar_leaf_m, "ground and surfaces of the map", kLeaf),
    HQSLAM_OPTION(mapping, located_planar_leaf_m,
                  "of the scan that is registered; LeGO-LOAM: as in the map", kLeaf),
    HQSLAM_OPTION(mapping, max_neighbour_distance_m, "how far the first two searches reach",
                  kPositive),
    HQSLAM_OPTION(mapping, close_neighbour_distance_m,
                  "and those that follow, where they find enough; LeGO-LOAM: 1 m for all",
                  kPositive),
    HQSLAM_OPTION(mapping, trusted_residual_m,
                  "of a feature from its line or plane: weights begin to fall from there, in the "
                  "close searches; LeGO-LOAM: by 0.09 for 0.1 m",
                  kPositive),
    HQSLAM_OPTION(mapping, max_plane_residual_m, "of the five points of a plane", kPositive),
    HQSLAM_OPTION(mapping, max_ground_residual_m, "the same for the ground; LeGO-LOAM: 0.2",
                  kPositive),
    HQSLAM_OPTION(
        mapping, recent_path_m,
        "sliding window: scans are matched with what so much path saw, or a loop restored; "
        "LeGO-LOAM: all of it",
        kPositive),
    HQSLAM_OPTION(mapping, key_frame_translation_m,
                  "a scan so far from the last one in the map is put into it", kNotNegative),
    HQSLAM_OPTION(mapping, key_frame_rotation_rad,
                  "or turned by so much; LIO-SAM's, LeGO-LOAM has none", kNotNegative),
    HQSLAM_OPTION(mapping, converged_rotation_rad, "a step below this is the last", kNotNegative),
    HQSLAM_OPTION(mapping, converged_translation_m, "the same", kNotNegative)};

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
    throw Error("there is no SLAM option {}; hqslam slam-options lists them", name);
  }
  require(found->holds(value), name, value, found->expected);
  const bool is_int = value == std::floor(value) && value <= std::numeric_limits<int>::max();
  require(is_int || !found->is_whole, name, value, "a whole number");
  found->set(options, value);
}

void validate(const SlamOptions& options) {
  const MappingOptions& mapping = options.mapping;
  require(options.threads >= 0 && options.threads <= kMostThreads, "threads", options.threads,
          "0 to 256");
  for (const NamedOption& option : kOptions) {
    const double value = option.get(options);
    require(option.holds(value), option.name, value, option.expected);
  }
  const MountingOptions& mounting = options.mounting;
  require(std::abs(std::cos(mounting.roll_rad) * std::cos(mounting.pitch_rad)) >= 0.5,
          "mounting.pitch_rad", mounting.pitch_rad,
          "a sensor within 60 degrees of upright or of upside down");
  require(options.features.edges_per_section >= options.features.sharp_edges_per_section,
          "features.edges_per_section", options.features.edges_per_section,
          "at least features.sharp_edges_per_section");
  require(mapping.close_neighbour_distance_m <= mapping.max_neighbour_distance_m,
          "mapping.close_neighbour_distance_m", mapping.close_neighbour_distance_m,
          "at most mapping.max_neighbour_distance_m");
  for (const auto& [name, leaf_m] : {std::pair{"mapping.edge_leaf_m", mapping.edge_leaf_m},
                                     {"mapping.planar_leaf_m", mapping.planar_leaf_m}}) {
    // A cube of the map numbers its voxels with 16 bits.
    require(leaf_m >= mapping.max_neighbour_distance_m / 20.0, name, leaf_m,
            "at least a twentieth of mapping.max_neighbour_distance_m");
  }
}

}  // namespace hqslam::slam
