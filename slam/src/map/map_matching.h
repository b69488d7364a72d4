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
};
/// The line through five neighbours, if they lie along one: the largest eigenvalue of their
/// covariance is more than ten times the second (three times in LOAM).
std::optional<MapLine> fit_line(const Neighbours& neighbours);

/// A plane through points, for a planar feature.
struct MapPlane {
  Eigen::Vector3d point_m;
  Eigen::Vector3d normal;
};
/// The plane through five neighbours, if they do not lie along a line and none is farther than
/// max_residual_m from the plane.
std::optional<MapPlane> fit_plane(const Neighbours& neighbours, double max_residual_m);

/// What five neighbours on a surface show of it: its plane, or, where all of them are of one row,
/// the line that the row drew on it.
using MapSurface = std::variant<MapPlane, MapLine>;
std::optional<MapSurface> fit_surface(const Neighbours& neighbours, double max_residual_m);

}  // namespace hqslam::slam
