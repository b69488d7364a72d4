#include <fmt/format.h>

#include "hqslam/slam/sensor_path.h"
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

/// The sensor's path during a scan: to and from its neighbours whose relative poses are known.
slam::SensorPath path_of(const SlamRun& run, std::size_t pose) {
  Trajectory near;
  if (pose > 0 && is_motion_known(run, pose - 1)) near.push_back(run.trajectory[pose - 1]);
  const std::size_t here = near.size();
  near.push_back(run.trajectory[pose]);
  if (pose + 1 < run.trajectory.size() && is_motion_known(run, pose)) {
    near.push_back(run.trajectory[pose + 1]);
  }
  return {near, here};
}

ViewScan scan_of(const SlamRun& run, const KeptScan& kept) {
  const StampedPose& pose = run.trajectory[kept.pose];
  ViewScan scan;
  scan.number = run.scans[kept.pose].scan;
  scan.name =
      fmt::format("scan {}, {:.1f} s", scan.number, pose.stamp_s - run.trajectory.front().stamp_s);
  scan.T_map_sensor = pose.T_map_sensor;
  const slam::SensorPath path = path_of(run, kept.pose);
  for (const KeptScan::Point& point : kept.points) {
    const bool is_measured = !run.measured_rows || run.measured_rows->contains(point.row);
    const Eigen::Vector3d place_m = path.at(point.time_offset_s) * point.point_m.cast<double>();
    (is_measured ? scan.measured : scan.upsampled).points_m.emplace_back(place_m.cast<float>());
  }
  return scan;
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
  for (const KeptScan& kept : run.kept_scans) {
    if (is_shown(kept.pose)) view.scans.push_back(scan_of(run, kept));
  }
  return view;
}

}  // namespace hqslam::tools
