#include "map/rooms.h"

#include <algorithm>

namespace hqslam::slam {

namespace {

/// Where a real OS0 was carried medians are 5.6 to 12.8 m; simulated ones: rooms.h.
constexpr float kEntered_m = 5.0F;
constexpr float kLeft_m = 7.0F;
constexpr float kShareOfScan = 0.1F;  // in the mean

float median_range_m(const std::vector<FeaturePoint>& points) {
  std::vector<float> range_m;
  range_m.reserve(points.size());
  for (const FeaturePoint& point : points) range_m.push_back(point.point_m.norm());
  const auto middle = range_m.begin() + std::ssize(range_m) / 2;
  std::ranges::nth_element(range_m, middle);
  return *middle;
}

}  // namespace

bool RoomCheck::add(const std::vector<FeaturePoint>& surfaces) {
  if (surfaces.empty()) return false;
  const float here_m = median_range_m(surfaces);
  range_m_ = range_m_ ? *range_m_ + kShareOfScan * (here_m - *range_m_) : here_m;
  const bool before = is_in_room_;
  is_in_room_ = *range_m_ < (before ? kLeft_m : kEntered_m);
  return is_in_room_ != before;
}

MappingOptions in_rooms(MappingOptions options) {
  options.planar_leaf_m *= 0.5;
  options.located_planar_leaf_m *= 0.5;
  options.max_plane_residual_m *= 0.25;
  return options;
}

}  // namespace hqslam::slam
