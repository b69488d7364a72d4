#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "front_end/segmentation.h"
#include "hqslam/core/organized_cloud.h"

namespace hqslam::slam {

/// A feature point as measured, not corrected for motion.
struct FeaturePoint {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< sensor frame at the time of capture
  float time_offset_s = 0.0F;                         ///< capture time minus the scan's stamp
  int row = 0;                                        ///< counted among the measured ones
  /// Unit direction of the surface across the row: on the ground and on what may be a ceiling
  /// (above the sensor, not shown to stand) the one that the rows above and below show, zero where
  /// they show none; upwards on all else.
  Eigen::Vector3f slope = Eigen::Vector3f::Zero();
  /// OrganizedCloud::intensity, NaN where unknown; carried along, never used to decide.
  float intensity = std::numeric_limits<float>::quiet_NaN();
};

/// LOAM's four kinds of features and posts, each ordered by row.
struct Features {
  std::vector<FeaturePoint> sharp_edges;  ///< the sharpest; matched from scan to scan
  std::vector<FeaturePoint> edges;        ///< more of them ("less sharp"), the sharpest included
  std::vector<FeaturePoint> flat_points;  ///< the flattest ground points; matched scan to scan
  std::vector<FeaturePoint> ground;       ///< ground points, thinned
  std::vector<FeaturePoint> surfaces;     ///< of objects, no edges ("less flat"), thinned
  std::vector<FeaturePoint> posts;  ///< narrow objects that stand alone, one point per row: posts.h
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< Segmentation::up
};

/// Chooses edge and planar features of a scan.
///
/// In: cloud (sensor frame), its segmentation. Out: features. The returns of a row form a sequence;
/// with their ranges r the smoothness of point i is
///   c_i = | sum over j = i-5..i+5, j != i, of r_j  -  10 r_i |        [m]
/// Points on the far side of a depth jump (occluded from elsewhere) and points on surfaces nearly
/// parallel to the beam are no edges or flat points. Each row is cut into sections; edges are the
/// largest c of a section, flat points the smallest, and neither has a neighbour of its kind within
/// 5 points. Short runs on objects that the rows beside do not show to stand are no features: most
/// are rings on undetected ground, which travel with the sensor. An edge on a post is the post's
/// centre (posts.h). Source: LOAM (Zhang & Singh 2014), LeGO-LOAM's featureAssociation.
///
/// measured_rows: SensorModel::measured_rows. Computed rows have no features: they only help to
/// separate the ground from what stands on it.
///
/// Differs from LeGO-LOAM: smoothness is compared with the range too, so that a distant surface is
/// no edge; the ground is not thinned to every fifth column before the smoothness is taken; the
/// last point of a section can be chosen too, and points at the ends of a row are compared only
/// with points of the same row and scan; all flat points, the fourth of a section too, suppress
/// their neighbours; rings are left out; there are posts, and edges on them are their centres.
Features extract_features(const OrganizedCloud& cloud, const Segmentation& segmentation,
                          const std::optional<RowSelection>& measured_rows = {});

}  // namespace hqslam::slam
