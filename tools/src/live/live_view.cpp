#include "live/live_view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "hqslam/slam/status.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPointsAtOnce = 20'000;
/// Every so many columns are enough for a picture.
constexpr int kColumnStep = 4;

/// The number behind "name=" in a query; 0 if there is none.
std::uint64_t number_in(std::string_view query, std::string_view name) {
  const std::string key = std::string(name) + "=";
  std::size_t at = query.find(key);
  while (at != std::string_view::npos && at > 0 && query[at - 1] != '&' && query[at - 1] != '?') {
    at = query.find(key, at + 1);
  }
  std::uint64_t value = 0;
  if (at != std::string_view::npos) {
    std::from_chars(query.data() + at + key.size(), query.data() + query.size(), value);
  }
  return value;
}

/// x, y, z, x, ... in whole centimetres, from `begin` on.
Json centimetres(const std::vector<Eigen::Vector3f>& points_m, std::size_t begin) {
  Json json = Json::array();
  const std::size_t end = std::min(points_m.size(), begin + kMostPointsAtOnce);
  for (std::size_t i = begin; i < end; ++i) {
    for (int axis = 0; axis < 3; ++axis) json.push_back(std::lround(100.0F * points_m[i][axis]));
  }
  return json;
}

}  // namespace

void LiveView::add_position(const Eigen::Vector3f& position_m) {
  if (!positions_m_.empty() && (position_m - positions_m_.back()).norm() < step_m_) return;
  positions_m_.push_back(position_m);
  if (positions_m_.size() < kMostPositions) return;
  for (std::size_t i = 0; 2 * i < positions_m_.size(); ++i) positions_m_[i] = positions_m_[2 * i];
  positions_m_.resize(positions_m_.size() / 2);
  step_m_ *= 2.0F;
  ++position_generation_;
}

void LiveView::add(const OrganizedCloud& cloud, const Pose& T_map_sensor) {
  const Eigen::Isometry3f T = T_map_sensor.cast<float>();
  const std::lock_guard lock(mutex_);
  T_map_sensor_ = T_map_sensor;
  add_position(T.translation());
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; column += kColumnStep) {
      const std::size_t pixel = cloud.index(row, column);
      if (cloud.range_m[pixel] > 0.0F) map_.add(T * cloud.points_m[pixel]);
    }
  }
}

void LiveView::replace(const Trajectory& trajectory,
                       const std::vector<Eigen::Vector3f>& map_points_m) {
  const std::lock_guard lock(mutex_);
  positions_m_.clear();
  ++position_generation_;
  for (const StampedPose& pose : trajectory) {
    add_position(pose.T_map_sensor.translation().cast<float>());
  }
  map_.clear();
  for (const Eigen::Vector3f& point_m : map_points_m) map_.add(point_m);
}

void LiveView::set(const LiveStatus& status) {
  const std::lock_guard lock(mutex_);
  status_ = status;
}

std::string LiveView::state(const std::string& query) const {
  const std::lock_guard lock(mutex_);
  const auto generation = static_cast<std::uint64_t>(map_.generation() + position_generation_);
  const bool same = number_in(query, "generation") == generation;
  const std::size_t positions =
      same ? std::min(number_in(query, "positions"), std::uint64_t{positions_m_.size()}) : 0;
  const std::size_t points =
      same ? std::min(number_in(query, "points"), std::uint64_t{map_.points_m().size()}) : 0;
  const Eigen::Vector3d position_m = T_map_sensor_.translation();
  const Eigen::Vector3d ahead = T_map_sensor_.linear().col(0);
  const Json json = {
      {"generation", generation},
      {"positions", centimetres(positions_m_, positions)},
      {"points", centimetres(map_.points_m(), points)},
      {"position_m", {position_m.x(), position_m.y(), position_m.z()}},
      {"heading_rad", std::atan2(ahead.y(), ahead.x())},
      {"rate_hz", status_.rate_hz},
      {"latency_ms", 1e3 * status_.latency_s.value_or(0.0)},
      {"scans", status_.scans},
      {"lost_packets", status_.counts.packets.lost},
      {"dropped_scans", status_.counts.dropped_scans},
      {"path_m", status_.path_m},
      {"mapping",
       status_.latest ? slam::name(status_.latest->report.mapping_status) : "no scan yet"},
  };
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ViewAnswer LiveView::answer(const std::string& target) const {
  const std::size_t query = target.find('?');
  const std::string path = target.substr(0, query);
  if (path == "/") return {200, "text/html; charset=utf-8", live_page(title_)};
  if (path == "/state") {
    return {200, "application/json",
            state(query == std::string::npos ? "" : target.substr(query + 1))};
  }
  return {404, "text/plain; charset=utf-8", "nothing here\n"};
}

}  // namespace hqslam::tools
