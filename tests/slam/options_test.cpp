#include "hqslam/slam/options.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "hqslam/core/error.h"

using hqslam::slam::SlamOptions;

namespace {

/// An option with its name. For every one there is in SlamOptions, flags aside.
template <typename Value>
struct Option {
  const char* name;
  Value& (*of)(SlamOptions& options);
};

#define OPTION(field)                                                    \
  {                                                                      \
#field, [](SlamOptions & options) -> auto& { return options.field; } \
  }

const std::vector<Option<double>> kNumbers = {OPTION(ground.max_slope_rad),
                                              OPTION(segmentation.min_angle_rad),
                                              OPTION(features.min_edge_smoothness_m),
                                              OPTION(features.min_edge_smoothness_per_range),
                                              OPTION(features.planar_leaf_m),
                                              OPTION(odometry.max_distance_m),
                                              OPTION(odometry.converged_rotation_rad),
                                              OPTION(odometry.converged_translation_m),
                                              OPTION(mapping.min_matched_share),
                                              OPTION(mapping.edge_leaf_m),
                                              OPTION(mapping.planar_leaf_m),
                                              OPTION(mapping.located_planar_leaf_m),
                                              OPTION(mapping.max_neighbour_distance_m),
                                              OPTION(mapping.close_neighbour_distance_m),
                                              OPTION(mapping.trusted_residual_m),
                                              OPTION(mapping.max_plane_residual_m),
                                              OPTION(mapping.max_ground_residual_m),
                                              OPTION(mapping.recent_path_m),
                                              OPTION(mapping.key_frame_translation_m),
                                              OPTION(mapping.key_frame_rotation_rad),
                                              OPTION(mapping.converged_rotation_rad),
                                              OPTION(mapping.converged_translation_m)};

const std::vector<Option<int>> kCounts = {OPTION(segmentation.min_pixels),
                                          OPTION(segmentation.min_pixels_tall),
                                          OPTION(segmentation.min_rows_tall),
                                          OPTION(features.sections),
                                          OPTION(features.sharp_edges_per_section),
                                          OPTION(features.edges_per_section),
                                          OPTION(features.flat_points_per_section),
                                          OPTION(odometry.max_iterations),
                                          OPTION(odometry.min_edges),
                                          OPTION(odometry.min_planar),
                                          OPTION(odometry.min_correspondences),
                                          OPTION(mapping.max_iterations),
                                          OPTION(mapping.min_correspondences)};

#undef OPTION

/// What validate() says about options; nothing if they are valid.
std::string complaint(const SlamOptions& options) {
  try {
    hqslam::slam::validate(options);
  } catch (const hqslam::Error& error) {
    return error.what();
  }
  return "";
}

/// Whether a value of one option is refused, by its name.
template <typename Value>
bool is_refused(const Option<Value>& option, Value value) {
  SlamOptions options;
  option.of(options) = value;
  return complaint(options).find(std::string("SLAM option ") + option.name + " is ") == 0;
}

}  // namespace

TEST_CASE("the default options are valid") { CHECK(complaint(SlamOptions{}).empty()); }

TEST_CASE("an invalid option is named with its value and the constraint") {
  SlamOptions options;
  options.segmentation.min_angle_rad = 2.0;
  CHECK(complaint(options) ==
        "SLAM option segmentation.min_angle_rad is 2, expected an angle between 0 and pi/2");
}

TEST_CASE("of every option what is below its bounds, infinite or no number is refused") {
  for (const Option<double>& number : kNumbers) {
    CAPTURE(number.name);
    CHECK(is_refused(number, -1.0));
    CHECK(is_refused(number, std::nan("")));
    CHECK(is_refused(number, std::numeric_limits<double>::infinity()));
  }
  for (const Option<int>& count : kCounts) {
    CAPTURE(count.name);
    CHECK(is_refused(count, -1));
    CHECK(is_refused(count, 0));
  }
}

TEST_CASE("options that do not go together, or ask for too much, are refused") {
  SlamOptions options;
  options.mapping.close_neighbour_distance_m = options.mapping.max_neighbour_distance_m + 0.1;
  CHECK(complaint(options).find("at most mapping.max_neighbour_distance_m") != std::string::npos);
  options = {};
  options.features.edges_per_section = options.features.sharp_edges_per_section - 1;
  CHECK(complaint(options).find("features.edges_per_section is 1") != std::string::npos);
  options = {};
  options.mapping.edge_leaf_m = 0.04;
  CHECK(complaint(options).find("at least a twentieth") != std::string::npos);
  options = {};
  options.features.planar_leaf_m = 0.0005;
  CHECK(complaint(options).find("0.001 or more") != std::string::npos);
  options = {};
  options.features.sections = 1 << 20;
  CHECK(complaint(options).find("1 to 1000") != std::string::npos);
  options = {};
  options.threads = -1;
  CHECK(complaint(options).find("threads is -1, expected 0 to 256") != std::string::npos);
  options.threads = 257;
  CHECK(!complaint(options).empty());
}

TEST_CASE("all of the map may be matched with, and every residual trusted") {
  SlamOptions options;
  options.mapping.recent_path_m = std::numeric_limits<double>::max();
  options.mapping.trusted_residual_m = std::numeric_limits<double>::max();
  CHECK(complaint(options).empty());
}
