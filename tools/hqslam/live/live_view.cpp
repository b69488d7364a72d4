#include "live/live_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "hqslam/slam/status.h"

namespace hqslam::tools {

namespace {

constexpr float kFarthest_m = 50'000.0F;

/// 21 bits of a coordinate: enough for 50 km in quarters of a metre on both sides.
std::uint64_t cell(float coordinate_m, float voxel_m) {
  const auto index = static_cast<std::int64_t>(std::floor(coordinate_m / voxel_m));
  return static_cast<std::uint64_t>(index + (1 << 20)) & 0x1FFFFF;
}

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

using Points = std::vector<Eigen::Vector3f>;

/// As many as are sent at once, from `begin` on.
template <typename Point>
std::vector<Point> points_from(const std::vector<Point>& points, std::uint64_t begin) {
  const std::size_t first = std::min<std::uint64_t>(begin, points.size());
  const std::size_t count = std::min(points.size() - first, kMostPointsAtOnce);
  const auto from = points.begin() + static_cast<std::ptrdiff_t>(first);
  return {from, from + static_cast<std::ptrdiff_t>(count)};
}

void append_centimetres(const Eigen::Vector3f& point_m, Json& json) {
  for (int axis = 0; axis < 3; ++axis) json.push_back(std::lround(100.0F * point_m[axis]));
}
/// x, y, z, x, ... in whole centimetres
Json centimetres(const Points& points_m) {
  Json json = Json::array();
  for (const Eigen::Vector3f& point_m : points_m) append_centimetres(point_m, json);
  return json;
}
/// x, y, z, segment, x, ...
Json centimetres(const std::vector<PathPosition>& positions) {
  Json json = Json::array();
  for (const PathPosition& position : positions) {
    append_centimetres(position.place_m, json);
    json.push_back(position.segment);
  }
  return json;
}

/// What a page is to be told, copied so that SLAM need not wait until it is written as text.
struct ViewState {
  std::uint64_t generation = 0;
  std::vector<PathPosition> positions;
  Points points_m;
  Pose T_map_sensor = Pose::Identity();
  std::size_t segment = 0;
  LiveStatus status;
};

std::string warning_of(const LiveStatus& status) {
  if (!status.results_failure.empty()) return "results are not written: " + status.results_failure;
  const std::string& recording = status.counts.recording_failure;
  if (!recording.empty()) return "not recorded any more: " + recording;
  if (!status.counts.trouble.empty()) return status.counts.trouble;
  if (status.parts < 2) return "";
  return fmt::format("{} parts of the path: how they lie to each other is not known", status.parts);
}

std::string json_of(const ViewState& state) {
  const Eigen::Vector3d position_m = state.T_map_sensor.translation();
  const Eigen::Vector3d ahead = state.T_map_sensor.linear().col(0);
  const LiveStatus& status = state.status;
  const Json json = {
      {"generation", state.generation},
      {"positions", centimetres(state.positions)},
      {"points", centimetres(state.points_m)},
      {"position_m", {position_m.x(), position_m.y(), position_m.z()}},
      {"segment", state.segment},
      {"heading_rad", std::atan2(ahead.y(), ahead.x())},
      {"rate_hz", status.rate_hz},
      {"latency_ms", 1e3 * status.latency_s.value_or(0.0)},
      {"scans", status.scans},
      {"lost_packets", status.counts.packets.lost},
      {"dropped_scans", status.counts.dropped_scans},
      {"path_m", status.path_m},
      {"mapping", status.latest ? slam::name(status.latest->report.mapping_status) : "no scan yet"},
      {"warning", warning_of(status)},
  };
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

bool LiveMap::take_voxel(const Eigen::Vector3f& point_m) {
  const std::uint64_t key = cell(point_m.x(), voxel_m_) << 42 | cell(point_m.y(), voxel_m_) << 21 |
                            cell(point_m.z(), voxel_m_);
  return taken_.insert(key).second;
}

void LiveMap::add(const Eigen::Vector3f& point_m, const Seen& seen) {
  if (!point_m.allFinite() || point_m.cwiseAbs().maxCoeff() > kFarthest_m) return;
  if (!take_voxel(point_m)) return;
  points_m_.push_back(point_m);
  seen_.push_back(seen);
  if (points_m_.size() >= kMostPoints) coarsen();
}

/// Until half of the room is free again.
void LiveMap::coarsen() {
  while (points_m_.size() > kMostPoints / 2) {
    voxel_m_ *= 2.0F;
    taken_.clear();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points_m_.size(); ++i) {
      if (!take_voxel(points_m_[i])) continue;
      points_m_[kept] = points_m_[i];
      seen_[kept++] = seen_[i];
    }
    points_m_.resize(kept);
    seen_.resize(kept);
  }
  ++generation_;
}

void LiveMap::move_to(const Trajectory& trajectory) {
  const std::vector<Seen> seen = std::exchange(seen_, {});
  points_m_.clear();
  taken_.clear();
  ++generation_;
  for (const Seen& point : seen) {
    if (point.scan >= trajectory.size()) continue;
    add(trajectory[point.scan].T_map_sensor.cast<float>() * point.point_m, point);
  }
}

std::vector<float> LiveMap::intensity() const {
  std::vector<float> intensity;
  intensity.reserve(seen_.size());
  for (const Seen& point : seen_) intensity.push_back(point.intensity);
  return intensity;
}

void LiveView::add_position(const PathPosition& position) {
  if (!positions_.empty() && positions_.back().segment == position.segment &&
      (position.place_m - positions_.back().place_m).norm() < step_m_) {
    return;
  }
  positions_.push_back(position);
  if (positions_.size() < kMostPositions) return;
  for (std::size_t i = 0; 2 * i < positions_.size(); ++i) positions_[i] = positions_[2 * i];
  positions_.resize(positions_.size() / 2);
  step_m_ *= 2.0F;
  ++position_generation_;
}

void LiveView::add(const OrganizedCloud& cloud, const Pose& T_map_sensor, std::size_t segment) {
  const Eigen::Isometry3f T = T_map_sensor.cast<float>();
  const std::lock_guard lock(mutex_);
  T_map_sensor_ = T_map_sensor;
  segment_ = segment;
  add_position({T.translation(), segment});
  last_scan_m_.clear();
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; column += kColumnStep) {
      const std::size_t pixel = cloud.index(row, column);
      if (!(cloud.range_m[pixel] > 0.0F)) continue;
      LiveMap::Seen seen{scans_, cloud.points_m[pixel]};
      if (!cloud.intensity.empty()) seen.intensity = cloud.intensity[pixel];
      map_.add(last_scan_m_.emplace_back(T * seen.point_m), seen);
    }
  }
  ++scans_;
}

void LiveView::replace(const Trajectory& trajectory,
                       const std::vector<std::size_t>& segment_of_scan) {
  const std::lock_guard lock(mutex_);
  positions_.clear();
  ++position_generation_;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    add_position({trajectory[i].T_map_sensor.translation().cast<float>(), segment_of_scan[i]});
  }
  map_.move_to(trajectory);
}

void LiveView::set(const LiveStatus& status) {
  const std::lock_guard lock(mutex_);
  status_ = status;
}

std::string LiveView::state(const std::string& query) const {
  ViewState state;
  {
    const std::lock_guard lock(mutex_);
    state.generation = static_cast<std::uint64_t>(map_.generation() + position_generation_);
    const bool same = number_in(query, "generation") == state.generation;
    state.positions = points_from(positions_, same ? number_in(query, "positions") : 0);
    state.points_m = points_from(map_.points_m(), same ? number_in(query, "points") : 0);
    state.T_map_sensor = T_map_sensor_;
    state.segment = segment_;
    state.status = status_;
  }
  return json_of(state);
}

TurningView LiveView::turning_view() const {
  constexpr std::size_t kMostPlaces = 2'000;
  TurningView view;
  const std::lock_guard lock(mutex_);
  view.clouds = {{"map", map_.points_m(), {}, map_.intensity()}};
  view.scans = {{"last scan", 0, T_map_sensor_, {"", last_scan_m_}, {}}};
  std::optional<std::size_t> segment;
  const auto add = [&](const PathPosition& position) {
    if (segment != position.segment) view.path_m.emplace_back();
    segment = position.segment;
    view.path_m.back().push_back(position.place_m);
  };
  const std::size_t every = 1 + positions_.size() / kMostPlaces;
  for (std::size_t i = 0; i < positions_.size(); i += every) add(positions_[i]);
  add({T_map_sensor_.translation().cast<float>(), segment_});
  return view;
}

ViewAnswer LiveView::answer(const std::string& target) const {
  const std::size_t query = target.find('?');
  const std::string path = target.substr(0, query);
  if (path == "/") return {200, "text/html; charset=utf-8", live_page(title_)};
  if (path == "/turning") {
    return {200, "text/html; charset=utf-8", live_turning_page(title_, turning_view())};
  }
  if (path == "/turning/data") return {200, "application/json", turning_view_data(turning_view())};
  if (path == "/state") {
    return {200, "application/json",
            state(query == std::string::npos ? "" : target.substr(query + 1))};
  }
  return {404, "text/plain; charset=utf-8", "nothing here\n"};
}

}  // namespace hqslam::tools
