#pragma once

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hqslam/slam/features.h"

namespace hqslam::slam {

/// Points ordered by row, and by azimuth within a row, with a kd-tree: the search target of the
/// odometry.
class RowOrderedCloud {
 public:
  /// `points_m`: the positions to search, one per point of `features` (whose rows are taken).
  RowOrderedCloud(const std::vector<FeaturePoint>& features,
                  const std::vector<Eigen::Vector3f>& points_m);

  std::size_t size() const { return points_m_.size(); }
  const Eigen::Vector3f& point_m(int i) const { return points_m_[i]; }

  /// The nearest point within max_distance_m.
  std::optional<int> nearest(const Eigen::Vector3f& query_m, double max_distance_m) const;
  /// The nearest other point in the row of point i.
  std::optional<int> nearest_in_row_of(int i, const Eigen::Vector3f& query_m,
                                       double max_distance_m) const;
  /// The nearest point in another row, at most two rows from that of point i.
  std::optional<int> nearest_near_row_of(int i, const Eigen::Vector3f& query_m,
                                         double max_distance_m) const;

 private:
  std::optional<int> nearest_in_row(int row, int except, const Eigen::Vector3f& query_m,
                                    float query_azimuth_rad, float& squared_distance_m2) const;
  std::vector<Eigen::Vector3f> points_m_;
  std::vector<Eigen::Vector2f> direction_;  ///< horizontal, of length 1
  std::vector<float> azimuth_rad_;
  std::vector<int> row_;
  std::vector<int> row_begin_;  ///< index of the first point of each row, and the end
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

}  // namespace hqslam::slam
