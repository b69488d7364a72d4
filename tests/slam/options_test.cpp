#include "hqslam/slam/options.h"

#include <doctest/doctest.h>

#include "hqslam/core/error.h"

using hqslam::slam::SlamOptions;

TEST_CASE("the default options are valid") { CHECK_NOTHROW(hqslam::slam::validate(SlamOptions{})); }

TEST_CASE("an invalid option is named with its value and the constraint") {
  SlamOptions options;
  options.segmentation.min_angle_rad = 2.0;
  CHECK_THROWS_WITH_AS(hqslam::slam::validate(options),
                       "SLAM option segmentation.min_angle_rad is 2, expected an angle between 0 "
                       "and pi/2",
                       hqslam::Error);
  options = SlamOptions{};
  options.mapping.edge_leaf_m = 0.001;
  CHECK_THROWS_AS(hqslam::slam::validate(options), hqslam::Error);
}
