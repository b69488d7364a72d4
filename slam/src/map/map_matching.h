#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>

#include "map/feature_map.h"

namespace hqslam::slam {

/// A line through points, for an edge feature.
struct MapLine {
  Eigen::Vector3d point_m;
  Eigen::Vector3d direction;
  double tilt = 0.0;  ///< standard deviation of the direction, rad
};
/// The line through five neighbours, if they are collinear: the largest eigenvalue of their
/// covariance is more than ten times the second (three times in LOAM).
std::optional<MapLine> fit_line(const Neighbours& neighbours);

/// A plane through points, for a planar feature.
struct MapPlane {
  Eigen::Vector3d point_m;
  Eigen::Vector3d normal;
  /// The direction in the plane towards which the normal is least known, times its standard
  /// deviation: of n points with distances of variance s^2 from the plane and the variance l along
  /// that direction it is s / sqrt(n l).
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
};
/// The plane through five neighbours, if they are not collinear and all within max_residual_m of
/// it.
std::optional<MapPlane> fit_plane(const Neighbours& neighbours, double max_residual_m);

/// The plane of five neighbours on a surface or, if all are of one row, their line.
using MapSurface = std::variant<MapPlane, MapLine>;
std::optional<MapSurface> fit_surface(const Neighbours& neighbours, double max_residual_m);

}  // namespace hqslam::slam
