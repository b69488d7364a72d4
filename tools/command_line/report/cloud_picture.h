#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/evaluation/png.h"
#include "report/chart.h"

namespace hqslam::tools {

/// A cloud to be drawn, with the path of the sensor that it was taken from; both in one frame.
struct CloudScene {
  const std::vector<Eigen::Vector3f>& points_m;
  const Trajectory& path;
  double point_m = 0.1;  ///< side of what a point stands for
};

/// The coordinates of an axis between which all points are but a share of them at either end.
std::array<double, 2> range_of(const std::vector<Eigen::Vector3f>& points_m, int axis,
                               double share);
/// The heights between which colours change: all but a few points', at least 1 m.
std::array<double, 2> range_of_heights(const std::vector<Eigen::Vector3f>& points_m);

/// From above, x to the right, y upwards, everything within 40 m of the path; colours tell heights.
/// Gaps between points stay gaps.
RgbImage cloud_from_above(const CloudScene& scene, int rows, int columns);

/// From behind and above the place where the sensor was after a third of its path, looking the way
/// that it went; colours tell heights about that place, shading tells edges in depth.
RgbImage cloud_in_perspective(const CloudScene& scene, int rows, int columns);

/// Points seen from above: each pixel is the darker, the more points lie over it (logarithmic, a
/// few grey levels so that the file is small). White where there is none. `box` in metres, x to
/// the right, y upwards.
RgbImage density_from_above(const std::vector<Eigen::Vector3f>& points_m, const PlotBox& box,
                            int rows, int columns);

/// Bytes as base64 (RFC 4648, with padding).
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace hqslam::tools
