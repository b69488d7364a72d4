#include "nearest_point.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace hqslam {

namespace {

/// Ranges of at most this many points are searched one by one.
constexpr std::size_t kLeafPoints = 12;

}  // namespace

NearestPoint::NearestPoint(std::vector<Eigen::Vector3f> points_m)
    : points_m_(std::move(points_m)), axis_(points_m_.size(), 0) {
  build(0, points_m_.size());
}

void NearestPoint::build(std::size_t begin, std::size_t end) {
  if (end - begin <= kLeafPoints) return;
  Eigen::Vector3f lowest = points_m_[begin];
  Eigen::Vector3f highest = points_m_[begin];
  for (std::size_t i = begin; i < end; ++i) {
    lowest = lowest.cwiseMin(points_m_[i]);
    highest = highest.cwiseMax(points_m_[i]);
  }
  int axis = 0;
  (highest - lowest).maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return points_m_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(
      at(begin), at(middle), at(end),
      [axis](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a[axis] < b[axis]; });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

double NearestPoint::squared_distance_m2(const Eigen::Vector3f& query_m) const {
  float nearest_m2 = std::numeric_limits<float>::infinity();
  search(0, points_m_.size(), query_m, nearest_m2);
  return nearest_m2;
}

void NearestPoint::search(std::size_t begin, std::size_t end, const Eigen::Vector3f& query_m,
                          float& nearest_m2) const {
  if (end - begin <= kLeafPoints) {
    for (std::size_t i = begin; i < end; ++i) {
      nearest_m2 = std::min(nearest_m2, (points_m_[i] - query_m).squaredNorm());
    }
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  nearest_m2 = std::min(nearest_m2, (points_m_[middle] - query_m).squaredNorm());
  const float beyond_m = query_m[axis_[middle]] - points_m_[middle][axis_[middle]];
  const bool before = beyond_m < 0.0F;
  before ? search(begin, middle, query_m, nearest_m2)
         : search(middle + 1, end, query_m, nearest_m2);
  if (beyond_m * beyond_m >= nearest_m2) return;
  before ? search(middle + 1, end, query_m, nearest_m2)
         : search(begin, middle, query_m, nearest_m2);
}

}  // namespace hqslam
