#include "dense_map/path_table.h"

#include <algorithm>
#include <cmath>

namespace hqslam::slam {

namespace {

constexpr int kEntries = 4096;

}  // namespace

PathTable::PathTable(const SensorPath& path, const OrganizedCloud& cloud)
    : time_offset_s_(cloud.time_offset_s) {
  if (time_offset_s_.empty()) {
    T_map_sensor_.push_back(path.at(0.0));
    return;
  }
  double last_s = 0.0;
  for (std::size_t pixel = 0; pixel < time_offset_s_.size(); ++pixel) {
    const double time_s = time_offset_s_[pixel];
    if (!(cloud.range_m[pixel] > 0.0F) || !std::isfinite(time_s)) continue;
    first_s_ = std::min(first_s_, time_s);
    last_s = std::max(last_s, time_s);
  }
  per_s_ = last_s > first_s_ ? (kEntries - 1) / (last_s - first_s_) : 0.0;
  const int entries = per_s_ > 0.0 ? kEntries : 1;
  T_map_sensor_.resize(static_cast<std::size_t>(entries));
#pragma omp parallel for schedule(static)
  for (int i = 0; i < entries; ++i) {
    T_map_sensor_[static_cast<std::size_t>(i)] =
        path.at(entries == 1 ? 0.0 : first_s_ + i / per_s_);
  }
}

const Pose& PathTable::at(std::size_t pixel) const {
  if (T_map_sensor_.size() == 1) return T_map_sensor_.front();
  const double entry = std::round((time_offset_s_[pixel] - first_s_) * per_s_);
  return T_map_sensor_[static_cast<std::size_t>(entry)];
}

}  // namespace hqslam::slam
