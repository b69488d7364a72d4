#include "front_end/row_ordered_cloud.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace hqslam::slam {

namespace {

constexpr int kRowReach = 2;   // as in LeGO-LOAM
constexpr int kSectors = 128;  // of a row; about as many as it has points

float azimuth_of(const Eigen::Vector3f& point_m) { return std::atan2(point_m.y(), point_m.x()); }

/// Monotonic in the azimuth.
int sector_of(float azimuth_rad) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const auto sector = static_cast<int>((azimuth_rad + kPi) * (kSectors / (2.0F * kPi)));
  return std::clamp(sector, 0, kSectors - 1);
}

/// (horizontal, vertical) of length 1
Eigen::Vector2f elevation_of(const Eigen::Vector3f& point_m) {
  return Eigen::Vector2f(point_m.head<2>().norm(), point_m.z()).normalized();
}

}  // namespace

RowQuery::RowQuery(const Eigen::Vector3f& query_m)
    : point_m(query_m), azimuth_rad(azimuth_of(query_m)) {}

RowOrderedCloud::RowOrderedCloud(const std::vector<FeaturePoint>& features,
                                 const std::vector<Eigen::Vector3f>& points_m) {
  struct Placed {
    std::size_t sector;
    float azimuth_rad;
    std::size_t feature;
  };
  std::vector<Placed> placed;
  placed.reserve(points_m.size());
  int rows = 0;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (!points_m[i].allFinite()) continue;
    const float azimuth_rad = azimuth_of(points_m[i]);
    const int row = features[i].row;
    placed.push_back(
        {static_cast<std::size_t>(row * kSectors + sector_of(azimuth_rad)), azimuth_rad, i});
    rows = std::max(rows, row + 1);
  }
  sector_begin_.assign(static_cast<std::size_t>(rows) * kSectors + 1, 0);
  for (const Placed& point : placed) ++sector_begin_[point.sector + 1];
  std::partial_sum(sector_begin_.begin(), sector_begin_.end(), sector_begin_.begin());
  std::vector<Placed> ordered(placed.size());
  std::vector<int> end(sector_begin_.begin(), sector_begin_.end() - 1);
  for (const Placed& point : placed) {  // into their sectors; few of them hold more than two
    int i = end[point.sector]++;
    for (; i > sector_begin_[point.sector] && ordered[i - 1].azimuth_rad > point.azimuth_rad; --i) {
      ordered[i] = ordered[i - 1];
    }
    ordered[i] = point;
  }
  row_.reserve(ordered.size());
  azimuth_rad_.reserve(ordered.size());
  points_m_.reserve(ordered.size());
  direction_.reserve(ordered.size());
  for (const Placed& point : ordered) {
    row_.push_back(features[point.feature].row);
    azimuth_rad_.push_back(point.azimuth_rad);
    points_m_.push_back(points_m[point.feature]);
    direction_.push_back(points_m[point.feature].head<2>().normalized());
  }
  find_elevations();
}

int RowOrderedCloud::rows() const { return static_cast<int>(sector_begin_.size()) / kSectors; }
int RowOrderedCloud::row_begin(int row) const { return sector_begin_[row * kSectors]; }

void RowOrderedCloud::find_elevations() {
  const auto higher = [](const auto& a, const auto& b) { return a.y() < b.y(); };
  Eigen::Vector2f lowest(0.0F, 1.0F);
  lowest_up_to_.resize(rows());
  for (int row = 0; row < rows(); ++row) {
    for (int i = row_begin(row); i < row_begin(row + 1); ++i) {
      lowest = std::min(lowest, elevation_of(points_m_[i]), higher);
    }
    lowest_up_to_[row] = lowest;
  }
  Eigen::Vector2f highest(0.0F, -1.0F);
  highest_from_.resize(rows());
  for (int row = rows() - 1; row >= 0; --row) {
    for (int i = row_begin(row); i < row_begin(row + 1); ++i) {
      highest = std::max(highest, elevation_of(points_m_[i]), higher);
    }
    highest_from_[row] = highest;
  }
}

/// Points of an elevation u above that of the query q are at least as far from it as it is from the
/// cone of u, |q x u| in the plane of (horizontal, vertical).
std::optional<int> RowOrderedCloud::nearest(const RowQuery& query, double max_distance_m) const {
  const Eigen::Vector3f& query_m = query.point_m;
  if (points_m_.empty() || !query_m.allFinite()) return std::nullopt;
  const Eigen::Vector2f q_m(query_m.head<2>().norm(), query_m.z());
  float nearest_m2 = static_cast<float>(max_distance_m * max_distance_m);
  std::optional<int> best;
  const auto search = [&](int row) {
    const auto found = nearest_in_row(row, std::nullopt, query, nearest_m2);
    if (found) best = found;
  };
  const auto too_far = [&](float to_cone_m) {
    return to_cone_m > 0.0F && to_cone_m * to_cone_m > nearest_m2;
  };
  const float distance_m = q_m.norm();
  const auto is_above = [&](const Eigen::Vector2f& u) { return u.y() * distance_m > q_m.y(); };
  const auto first = std::ranges::partition_point(lowest_up_to_, is_above);
  const int start = static_cast<int>(first - lowest_up_to_.begin());
  for (int row = start; row < rows(); ++row) {
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

/// Number of points of the row before the azimuth.
int RowOrderedCloud::first_from(int row, float azimuth_rad) const {
  const int sector = row * kSectors + sector_of(azimuth_rad);
  int i = sector_begin_[sector];
  while (i < sector_begin_[sector + 1] && azimuth_rad_[i] < azimuth_rad) ++i;
  return i - row_begin(row);
}

/// Walks away from the query's azimuth on both sides. A point whose direction from the vertical
/// axis is u is at least as far from the query q as q is from the ray along u, |q x u|, or |q|
/// where the ray points away: beyond the best distance so far the walk ends.
std::optional<int> RowOrderedCloud::nearest_in_row(int row, std::optional<int> except,
                                                   const RowQuery& query,
                                                   float& squared_distance_m2) const {
  const int begin = row_begin(row);
  const int count = row_begin(row + 1) - begin;
  if (count == 0) return std::nullopt;
  const Eigen::Vector3f& query_m = query.point_m;
  const float rho_m2 = query_m.head<2>().squaredNorm();
  const int start = first_from(row, query.azimuth_rad);
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

std::optional<int> RowOrderedCloud::nearest_in_row_of(int i, const RowQuery& query,
                                                      double max_distance_m) const {
  float nearest_m2 = static_cast<float>(max_distance_m * max_distance_m);
  return nearest_in_row(row_[i], i, query, nearest_m2);
}

std::optional<int> RowOrderedCloud::nearest_near_row_of(int i, const RowQuery& query,
                                                        double max_distance_m) const {
  const int first = std::max(0, row_[i] - kRowReach);
  const int last = std::min(rows() - 1, row_[i] + kRowReach);
  float nearest_m2 = static_cast<float>(max_distance_m * max_distance_m);
  std::optional<int> best;
  for (int row = first; row <= last; ++row) {
    if (row == row_[i]) continue;
    const auto found = nearest_in_row(row, std::nullopt, query, nearest_m2);
    if (found) best = found;
  }
  return best;
}

}  // namespace hqslam::slam
