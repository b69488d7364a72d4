#include <fmt/format.h>

#include "run/report_page.h"

namespace hqslam::tools {
namespace {

ViewCloud cloud_of(const DenseMapRun& map) {
  ViewCloud cloud{"dense map", {}, {}};
  for (const slam::DenseMapPoint& point : map.points) {
    cloud.points_m.push_back(point.point_m);
    cloud.confidence.push_back(point.confidence);
  }
  cloud.intensity = map.intensity;
  return cloud;
}

/// The scan with the pose of a neighbour, the next one if the motion to it is known.
ViewRangeImage image_of(const SlamRun& run, const KeptScan& kept) {
  const std::size_t here = kept.pose;
  const bool has_next = here + 1 < run.trajectory.size() && is_motion_known(run, here);
  const bool has_last = here > 0 && is_motion_known(run, here - 1);
  const StampedPose& pose = run.trajectory[here];
  const StampedPose& other = run.trajectory[has_next ? here + 1 : has_last ? here - 1 : here];
  const std::int64_t number = run.scans[here].scan;
  const double time_s = pose.stamp_s - run.trajectory.front().stamp_s;
  return {fmt::format("scan {}, {:.1f} s", number, time_s),
          number,
          pose.T_map_sensor,
          other.T_map_sensor,
          other.stamp_s - pose.stamp_s,
          kept.range,
          kept.time_offset_s};
}

}  // namespace

TurningView view_of(const SlamRun& run, const DenseMapRun* dense_map) {
  TurningView view;
  if (dense_map != nullptr) view.clouds.push_back(cloud_of(*dense_map));
  if (!run.map_points_m.empty()) {
    view.clouds.push_back({"features", run.map_points_m, {}, run.map_intensity});
  }
  const auto is_shown = [&](std::size_t pose) {
    return pose < run.trajectory.size() && run.submap_of_scan[pose] == run.largest_submap;
  };
  const auto place_m = [&](std::size_t pose) {
    return Eigen::Vector3f(run.trajectory[pose].T_map_sensor.translation().cast<float>());
  };
  ViewPath& path = view.paths.emplace_back(ViewPath{"path"});
  for (std::size_t pose = 0; pose < run.trajectory.size(); ++pose) {
    if (!is_shown(pose)) continue;
    const bool goes_on = pose > 0 && is_shown(pose - 1) && is_motion_known(run, pose - 1);
    if (!goes_on) path.pieces_m.emplace_back();
    path.pieces_m.back().push_back(place_m(pose));
  }
  for (const slam::LoopReport& loop : run.loops) {
    if (!is_shown(loop.scan) || !is_shown(loop.older_scan)) continue;
    view.loops_m.emplace_back(place_m(loop.older_scan), place_m(loop.scan));
  }
  view.drive.sensor = run.sensor;
  for (const KeptScan& kept : run.kept_scans) {
    if (is_shown(kept.pose)) view.drive.scans.push_back(image_of(run, kept));
  }
  return view;
}

}  // namespace hqslam::tools
