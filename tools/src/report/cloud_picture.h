#pragma once

#include <Eigen/Core>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/evaluation/png.h"

namespace hqslam::tools {

/// A cloud to be drawn, with the path of the sensor that it was taken from; both in one frame.
struct CloudScene {
  const std::vector<Eigen::Vector3f>& points_m;
  const Trajectory& path;
  double point_m = 0.1;  ///< side of what a point stands for
};

/// From above, x to the right, y upwards, everything within 40 m of the path; colours tell heights.
/// Gaps between points stay gaps.
RgbImage cloud_from_above(const CloudScene& scene, int rows, int columns);

/// From behind and above the place where the sensor was after a third of its path, looking the way
/// that it went; colours tell heights about that place, shading tells edges in depth.
RgbImage cloud_in_perspective(const CloudScene& scene, int rows, int columns);

}  // namespace hqslam::tools
