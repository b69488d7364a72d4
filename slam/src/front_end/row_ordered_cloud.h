#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "front_end/features.h"

namespace hqslam::slam {

/// A point whose neighbours are sought.
struct RowQuery {
  explicit RowQuery(const Eigen::Vector3f& query_m);
  Eigen::Vector3f point_m;
  float azimuth_rad;
};

/// Points ordered by row, and by azimuth within a row: the search target of the odometry, which
/// seeks nearest points in one row, in rows nearby and in all rows.
///
/// The order serves as the index: from the row at the query's elevation the search goes up and down
/// while the rows beyond can be nearer than the best so far, and in each row from the query's
/// azimuth in both directions likewise. Each direction takes at most half of the row's points:
/// exact where they are all around; in a row with points on one side only the nearest can be missed
/// if more than half of them precede it. LeGO-LOAM builds a kd-tree for every scan.
class RowOrderedCloud {
 public:
  RowOrderedCloud() = default;
  /// `points_m`: the positions to search, one per point of `features` (whose rows are taken); those
  /// that are not finite are left out.
  RowOrderedCloud(const std::vector<FeaturePoint>& features,
                  const std::vector<Eigen::Vector3f>& points_m);

  std::size_t size() const { return points_m_.size(); }
  const Eigen::Vector3f& point_m(int i) const { return points_m_[i]; }

  /// The nearest point within max_distance_m.
  std::optional<int> nearest(const RowQuery& query, double max_distance_m) const;
  /// The nearest other point in the row of point i.
  std::optional<int> nearest_in_row_of(int i, const RowQuery& query, double max_distance_m) const;
  /// The nearest point in another row, at most two rows from that of point i.
  std::optional<int> nearest_near_row_of(int i, const RowQuery& query, double max_distance_m) const;

 private:
  int rows() const;
  int row_begin(int row) const;
  void find_elevations();
  int first_from(int row, float azimuth_rad) const;
  std::optional<int> nearest_in_row(int row, std::optional<int> except, const RowQuery& query,
                                    float& squared_distance_m2) const;
  std::vector<Eigen::Vector3f> points_m_;
  std::vector<Eigen::Vector2f> direction_;  ///< horizontal, of length 1
  std::vector<float> azimuth_rad_;
  std::vector<int> row_;
  std::vector<int> sector_begin_;  ///< index of the first point per row and sector, and the end
  /// Elevations as unit vectors (horizontal, vertical). Per row: the highest of the points from
  /// this row on, the lowest of those up to it.
  std::vector<Eigen::Vector2f> highest_from_;
  std::vector<Eigen::Vector2f> lowest_up_to_;
};

}  // namespace hqslam::slam
