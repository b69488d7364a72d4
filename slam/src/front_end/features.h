#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "front_end/segmentation.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/options.h"

namespace hqslam::slam {

/// A point of a scan as it was measured (not corrected for motion).
struct FeaturePoint {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< sensor frame at the time of capture
  float time_offset_s = 0.0F;                         ///< capture time minus the scan's stamp
  int row = 0;                                        ///< counted among the measured ones
  /// Of the ground: the direction of its slope across the row, towards the row above or away from
  /// it, of length 1. Zero where the rows beside it have no ground there, and of all else.
  Eigen::Vector3f slope = Eigen::Vector3f::Zero();
  /// OrganizedCloud::intensity, not a number where that is not known; nothing is decided by it.
  float intensity = std::numeric_limits<float>::quiet_NaN();
};

/// LOAM's four kinds of features and posts, each ordered by row.
struct Features {
  std::vector<FeaturePoint> sharp_edges;  ///< the sharpest; matched from scan to scan
  std::vector<FeaturePoint> edges;        ///< more of them ("less sharp"), the sharpest included
  std::vector<FeaturePoint> flat_points;  ///< the flattest ground points; matched scan to scan
  std::vector<FeaturePoint> ground;       ///< ground points, thinned
  std::vector<FeaturePoint> surfaces;     ///< clusters' points that are no edges ("less flat"), and
                                          ///< the outliers of every fifth column; thinned
  std::vector<FeaturePoint> posts;  ///< narrow things that stand alone, one point per row: posts.h
};

/// Chooses edge and planar features of a scan.
///
/// In: cloud (sensor frame), its segmentation. Out: features. Within each row, returns of ground
/// and clusters follow each other; with their ranges r the smoothness of point i is
///   c_i = | sum over j = i-5..i+5, j != i, of r_j  -  10 r_i |        [m]
/// Points on the far side of a depth jump (they may be hidden from elsewhere) and points on
/// surfaces nearly parallel to the beam are never features. Each row is cut into sections; edges
/// are the largest c of a section, flat points the smallest, and neither has a neighbour of its
/// kind within 5 points. Source: LOAM (Zhang & Singh 2014), LeGO-LOAM's featureAssociation.
///
/// measured_rows: SensorModel::measured_rows. Computed rows have no features: they tell ground from
/// what stands on it, and have nothing to say about the pose.
///
/// Differs from LeGO-LOAM: smoothness is judged against the range as well as by itself, so that a
/// distant surface is no edge; the ground is not thinned to every fifth column before the
/// smoothness is taken; every point of a section takes part in the choice, the last one too, and
/// points at the ends of a row are only ever compared with points of the same row and scan; all
/// flat points, the fourth of a section too, keep their neighbours from being chosen; and there are
/// posts.
Features extract_features(const OrganizedCloud& cloud, const Segmentation& segmentation,
                          const FeatureOptions& options,
                          const std::optional<RowSelection>& measured_rows = {});

}  // namespace hqslam::slam
