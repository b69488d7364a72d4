#include "row_ordered_cloud.h"

#include <algorithm>

namespace hqslam::slam {

namespace {

constexpr int kRowReach = 2;

}  // namespace

RowOrderedCloud::RowOrderedCloud(const std::vector<FeaturePoint>& features,
                                 const std::vector<Eigen::Vector3f>& points_m)
    : points_m_(points_m) {
  for (const FeaturePoint& feature : features) {
    while (static_cast<int>(row_begin_.size()) <= feature.row) {
      row_begin_.push_back(static_cast<int>(row_.size()));
    }
    row_.push_back(feature.row);
  }
  row_begin_.push_back(static_cast<int>(row_.size()));
  if (points_m_.empty()) return;
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(points_m_.size());
  for (const Eigen::Vector3f& p : points_m_) cloud->push_back({p.x(), p.y(), p.z()});
  tree_.setInputCloud(cloud);
}

std::optional<int> RowOrderedCloud::nearest(const Eigen::Vector3f& query_m,
                                            double max_distance_m) const {
  if (points_m_.empty() || !query_m.allFinite()) return std::nullopt;
  pcl::Indices index(1);
  std::vector<float> squared_distance_m2(1);
  const pcl::PointXYZ query(query_m.x(), query_m.y(), query_m.z());
  if (tree_.nearestKSearch(query, 1, index, squared_distance_m2) < 1) return std::nullopt;
  if (squared_distance_m2[0] > max_distance_m * max_distance_m) return std::nullopt;
  return index[0];
}

std::optional<int> RowOrderedCloud::nearest_among(int first, int last, int except,
                                                  const Eigen::Vector3f& query_m,
                                                  float& squared_distance_m2) const {
  std::optional<int> best;
  for (int i = first; i < last; ++i) {
    const float candidate_m2 = (points_m_[i] - query_m).squaredNorm();
    if (candidate_m2 < squared_distance_m2 && i != except) {
      squared_distance_m2 = candidate_m2;
      best = i;
    }
  }
  return best;
}

std::optional<int> RowOrderedCloud::nearest_in_row_of(int i, const Eigen::Vector3f& query_m,
                                                      double max_distance_m) const {
  auto limit_m2 = static_cast<float>(max_distance_m * max_distance_m);
  return nearest_among(row_begin_[row_[i]], row_begin_[row_[i] + 1], i, query_m, limit_m2);
}

std::optional<int> RowOrderedCloud::nearest_near_row_of(int i, const Eigen::Vector3f& query_m,
                                                        double max_distance_m) const {
  auto limit_m2 = static_cast<float>(max_distance_m * max_distance_m);
  const int rows = static_cast<int>(row_begin_.size()) - 1;
  std::optional<int> best;
  for (int row = std::max(0, row_[i] - kRowReach); row <= std::min(rows - 1, row_[i] + kRowReach);
       ++row) {
    if (row == row_[i]) continue;
    const auto found = nearest_among(row_begin_[row], row_begin_[row + 1], i, query_m, limit_m2);
    if (found) best = found;
  }
  return best;
}

}  // namespace hqslam::slam
