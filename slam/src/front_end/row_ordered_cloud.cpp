#include "front_end/row_ordered_cloud.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hqslam::slam {

namespace {

constexpr int kRowReach = 2;

float azimuth_of(const Eigen::Vector3f& point_m) { return std::atan2(point_m.y(), point_m.x()); }

/// (horizontal, vertical) of length 1
Eigen::Vector2f elevation_of(const Eigen::Vector3f& point_m) {
  return Eigen::Vector2f(point_m.head<2>().norm(), point_m.z()).normalized();
}

}  // namespace

RowOrderedCloud::RowOrderedCloud(const std::vector<FeaturePoint>& features,
                                 const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<float> azimuth_rad(points_m.size());
  std::vector<int> order;
  order.reserve(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (!points_m[i].allFinite()) continue;
    azimuth_rad[i] = azimuth_of(points_m[i]);
    order.push_back(static_cast<int>(i));
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(features[a].row, azimuth_rad[a]) < std::pair(features[b].row, azimuth_rad[b]);
  });
  for (const int i : order) {
    while (static_cast<int>(row_begin_.size()) <= features[i].row) {
      row_begin_.push_back(static_cast<int>(row_.size()));
    }
    row_.push_back(features[i].row);
    azimuth_rad_.push_back(azimuth_rad[i]);
    points_m_.push_back(points_m[i]);
    direction_.push_back(points_m[i].head<2>().normalized());
  }
  row_begin_.push_back(static_cast<int>(row_.size()));
  find_elevations();
}

void RowOrderedCloud::find_elevations() {
  const std::size_t rows = row_begin_.size() - 1;
  const auto higher = [](const auto& a, const auto& b) { return a.y() < b.y(); };
  Eigen::Vector2f lowest(0.0F, 1.0F);
  lowest_up_to_.resize(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    for (int i = row_begin_[row]; i < row_begin_[row + 1]; ++i) {
      lowest = std::min(lowest, elevation_of(points_m_[i]), higher);
    }
    lowest_up_to_[row] = lowest;
  }
  Eigen::Vector2f highest(0.0F, -1.0F);
  highest_from_.resize(rows);
  for (std::size_t row = rows; row-- > 0;) {
    for (int i = row_begin_[row]; i < row_begin_[row + 1]; ++i) {
      highest = std::max(highest, elevation_of(points_m_[i]), higher);
    }
    highest_from_[row] = highest;
  }
}

/// Points of an elevation u above that of the query q are at least as far from it as it is from the
/// cone of u, |q x u| in the plane of (horizontal, vertical).
std::optional<int> RowOrderedCloud::nearest(const Eigen::Vector3f& query_m,
                                            double max_distance_m) const {
  if (points_m_.empty() || !query_m.allFinite()) return std::nullopt;
  const Eigen::Vector2f q_m(query_m.head<2>().norm(), query_m.z());
  const float azimuth_rad = azimuth_of(query_m);
  auto limit_m2 = static_cast<float>(max_distance_m * max_distance_m);
  std::optional<int> best;
  const auto search = [&](int row) {
    const auto found = nearest_in_row(row, std::nullopt, query_m, azimuth_rad, limit_m2);
    if (found) best = found;
  };
  const auto too_far = [&](float to_cone_m) {
    return to_cone_m > 0.0F && to_cone_m * to_cone_m > limit_m2;
  };
  const float distance_m = q_m.norm();
  const auto is_above = [&](const Eigen::Vector2f& u) { return u.y() * distance_m > q_m.y(); };
  const auto first = std::partition_point(lowest_up_to_.begin(), lowest_up_to_.end(), is_above);
  const int rows = static_cast<int>(lowest_up_to_.size());
  const int start = static_cast<int>(first - lowest_up_to_.begin());
  for (int row = start; row < rows; ++row) {
    const Eigen::Vector2f& u = highest_from_[row];
    if (too_far(q_m.y() * u.x() - q_m.x() * u.y())) break;
    search(row);
  }
  for (int row = start - 1; row >= 0; --row) {
    const Eigen::Vector2f& u = lowest_up_to_[row];
    if (too_far(q_m.x() * u.y() - q_m.y() * u.x())) break;
    search(row);
  }
  return best;
}

/// Walks away from the query's azimuth on both sides. A point whose direction from the vertical
/// axis is u is at least as far from the query q as q is from the ray along u, |q x u|, or |q|
/// where the ray points away: beyond the best distance so far the walk ends.
std::optional<int> RowOrderedCloud::nearest_in_row(int row, std::optional<int> except,
                                                   const Eigen::Vector3f& query_m,
                                                   float query_azimuth_rad,
                                                   float& squared_distance_m2) const {
  const int begin = row_begin_[row];
  const int count = row_begin_[row + 1] - begin;
  if (count == 0) return std::nullopt;
  const float rho_m2 = query_m.head<2>().squaredNorm();
  const auto first = azimuth_rad_.begin() + begin;
  const int start =
      static_cast<int>(std::lower_bound(first, first + count, query_azimuth_rad) - first);
  std::optional<int> best;
  for (const int direction : {1, -1}) {
    // Around half the circle on each side; the index wraps as the scan does.
    for (int step = direction == 1 ? 0 : 1; step <= count / 2; ++step) {
      int i = start + direction * step;
      if (i < 0) i += count;
      if (i >= count) i -= count;
      i += begin;
      const Eigen::Vector2f& u = direction_[i];
      const float lateral_m = query_m.x() * u.y() - query_m.y() * u.x();
      const bool ahead = query_m.head<2>().dot(u) >= 0.0F;
      if ((ahead ? lateral_m * lateral_m : rho_m2) > squared_distance_m2) break;
      const float candidate_m2 = (points_m_[i] - query_m).squaredNorm();
      if (candidate_m2 < squared_distance_m2 && i != except) {
        squared_distance_m2 = candidate_m2;
        best = i;
      }
    }
  }
  return best;
}

std::optional<int> RowOrderedCloud::nearest_in_row_of(int i, const Eigen::Vector3f& query_m,
                                                      double max_distance_m) const {
  auto limit_m2 = static_cast<float>(max_distance_m * max_distance_m);
  return nearest_in_row(row_[i], i, query_m, azimuth_of(query_m), limit_m2);
}

std::optional<int> RowOrderedCloud::nearest_near_row_of(int i, const Eigen::Vector3f& query_m,
                                                        double max_distance_m) const {
  auto limit_m2 = static_cast<float>(max_distance_m * max_distance_m);
  const float azimuth_rad = azimuth_of(query_m);
  const int rows = static_cast<int>(row_begin_.size()) - 1;
  std::optional<int> best;
  for (int row = std::max(0, row_[i] - kRowReach); row <= std::min(rows - 1, row_[i] + kRowReach);
       ++row) {
    if (row == row_[i]) continue;
    const auto found = nearest_in_row(row, i, query_m, azimuth_rad, limit_m2);
    if (found) best = found;
  }
  return best;
}

}  // namespace hqslam::slam
