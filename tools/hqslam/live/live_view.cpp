#include "live/live_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hqslam/slam/status.h"
#include "pages/page.h"

namespace hqslam::tools {

namespace {

constexpr float kFarthest_m = 50'000.0F;

/// 21 bits of a coordinate: enough for 50 km in quarters of a metre on both sides.
std::uint64_t cell(float coordinate_m, float voxel_m) {
  const auto index = static_cast<std::int64_t>(std::floor(coordinate_m / voxel_m));
  return static_cast<std::uint64_t>(index + (1 << 20)) & 0x1FFFFF;
}

/// One column of this number is enough for a picture.
constexpr int kColumnStep = 4;

std::string warning_of(const LiveStatus& status) {
  if (!status.results_failure.empty()) return "results are not written: " + status.results_failure;
  const std::string& recording = status.counts.recording_failure;
  if (!recording.empty()) return "not recorded any more: " + recording;
  if (!status.counts.trouble.empty()) return status.counts.trouble;
  if (status.submaps < 2) return "";
  return fmt::format("{} submaps, relative pose unknown", status.submaps);
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
}

void LiveMap::move_to(const Trajectory& trajectory) {
  const std::vector<Seen> seen = std::exchange(seen_, {});
  points_m_.clear();
  taken_.clear();
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
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    add_position({trajectory[i].T_map_sensor.translation().cast<float>(), segment_of_scan[i]});
  }
  map_.move_to(trajectory);
}

void LiveView::set(const LiveStatus& status) {
  const std::lock_guard lock(mutex_);
  status_ = status;
}

std::string LiveView::state() const {
  const std::lock_guard lock(mutex_);
  const Eigen::Vector3d position_m = T_map_sensor_.translation();
  const Eigen::Vector3d ahead = T_map_sensor_.linear().col(0);
  PageJson json = {
      {"position_m", {position_m.x(), position_m.y(), position_m.z()}},
      {"heading_rad", std::atan2(ahead.y(), ahead.x())},
      {"segment", segment_},
      {"rate_hz", status_.rate_hz},
      {"scans", status_.scans},
      {"lost_packets", status_.counts.packets.lost},
      {"dropped_scans", status_.counts.dropped_scans},
      {"path_m", status_.path_m},
      {"mapping",
       status_.latest ? slam::name(status_.latest->report.mapping_status) : "no scan yet"},
      {"warning", warning_of(status_)},
  };
  if (status_.latency_s) json["latency_ms"] = 1e3 * *status_.latency_s;
  return json.dump(-1, ' ', false, PageJson::error_handler_t::replace);
}

TurningView LiveView::turning_view() const {
  constexpr std::size_t kMostPlaces = 2'000;
  TurningView view;
  const std::lock_guard lock(mutex_);
  view.clouds = {{"map", map_.points_m(), {}, map_.intensity()}};
  view.last_scan = {"last scan", T_map_sensor_, {"", last_scan_m_}};
  ViewPath& path = view.paths.emplace_back(ViewPath{"path"});
  std::optional<std::size_t> segment;
  const auto add = [&](const PathPosition& position) {
    if (segment != position.segment) path.pieces_m.emplace_back();
    segment = position.segment;
    path.pieces_m.back().push_back(position.place_m);
  };
  const std::size_t every = 1 + positions_.size() / kMostPlaces;
  for (std::size_t i = 0; i < positions_.size(); i += every) add(positions_[i]);
  add({T_map_sensor_.translation().cast<float>(), segment_});
  return view;
}

ViewAnswer LiveView::answer(const std::string& target) const {
  const std::string path = target.substr(0, target.find('?'));
  if (path == "/") {
    return {200, "text/html; charset=utf-8",
            page_html("live", {{"title", title_}, {"view", turning_view_json(turning_view())}})};
  }
  if (path == "/view") {
    const PageJson view = turning_view_json(turning_view());
    return {200, "application/json", view.dump(-1, ' ', true, PageJson::error_handler_t::replace)};
  }
  if (path == "/state") return {200, "application/json", state()};
  return {404, "text/plain; charset=utf-8", "nothing here\n"};
}

}  // namespace hqslam::tools
