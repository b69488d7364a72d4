#include "run/report_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <optional>

#include "hqslam/core/angles.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "pages/page.h"
#include "pages/text_table.h"
#include "program/invocation.h"

namespace hqslam::tools {
namespace {

using Json = PageJson;

Json number(const char* label, std::string value, const char* unit = "", std::string note = "") {
  return {{"label", label}, {"value", std::move(value)}, {"unit", unit}, {"note", std::move(note)}};
}

Json path_length(const SlamRun& run) {
  const double path_m = known_path_m(run);
  if (path_m < 10000.0) return number("Path length", fmt::format("{:.1f}", path_m), "m");
  return number("Path length", fmt::format("{:.2f}", 1e-3 * path_m), "km");
}

Json numbers_json(const SlamRun& run) {
  const char* const from = run.command == "live" ? "received" : "in the recording";
  Json numbers = {
      number("Scans", fmt::format("{}", run.scans.size()), "",
             run.scans_in_recording ? fmt::format("of {} {}", *run.scans_in_recording, from) : ""),
      path_length(run)};
  if (run.comparison) {
    const double rmse_m = run.comparison->error.translation_statistics.rmse;
    numbers.push_back(number("Position error", fmt::format("{:.3f}", rmse_m), "m", "APE, RMSE"));
  }
  numbers.push_back(
      number("Scans per second", fmt::format("{:.1f}", scans_per_second(run)), "",
             fmt::format("with reading, {} thread{}", run.threads, run.threads == 1 ? "" : "s")));
  numbers.push_back(number("SLAM per scan",
                           fmt::format("{:.1f}", statistics_of(slam_times(run).times_ms).median),
                           "ms", "median"));
  if (run.slam.loop_closing.enabled) {
    const std::size_t submaps = scans_of_submaps(run).size();
    numbers.push_back(number("Loops closed", fmt::format("{}", loops_closed(run)), "",
                             submaps > 1 ? fmt::format("{} submaps not joined", submaps) : ""));
  }
  numbers.push_back(number("Features of the map", fmt::format("{}", run.map_points_m.size()), "",
                           "points of map.pcd"));
  return numbers;
}

Json notices_json(const SlamRun& run) {
  if (run.end == ReadingEnd::kComplete) return Json::array();
  return {
      fmt::format("The run ended after {}: {}. The results are valid up to there.",
                  scans_text(std::ssize(run.scans), run.scans_in_recording),
                  run.end == ReadingEnd::kInterrupted ? "it was interrupted" : run.end_message)};
}

/// A value of each pose.
template <typename Value>
Json of_poses(const Trajectory& trajectory, const Value& value) {
  std::vector<float> values;
  values.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) values.push_back(static_cast<float>(value(pose)));
  return f32_block(values);
}

std::vector<slam::Status> statuses() {
  std::vector<slam::Status> kinds;
  for (const auto& [kind, scans] : status_counts({}, &slam::ScanReport::mapping_status)) {
    kinds.push_back(kind);
  }
  return kinds;
}

/// Standard deviations of each pose along and about the sensor's x, y and z: metres, then degrees.
Json sigmas_json(const SlamRun& run) {
  Json all = Json::array();
  for (int axis = 0; axis < 6; ++axis) {
    const double unit = axis < 3 ? 1.0 : kDegreesPerRadian;
    std::vector<float> sigma;
    for (std::size_t i = 0; i < run.trajectory.size(); ++i) {
      const double variance = run.scans[i].report.covariance(axis, axis);
      sigma.push_back(static_cast<float>(unit * std::sqrt(std::max(0.0, variance))));
    }
    all.push_back(f32_block(sigma));
  }
  return all;
}

/// A value per pose of the trajectory, of which the last scan may have none yet.
Json trajectory_json(const SlamRun& run) {
  const Trajectory& trajectory = run.trajectory;
  const auto stamp_s = trajectory.empty() ? 0.0 : trajectory.front().stamp_s;
  const auto position_m = [&](int axis) {
    return of_poses(trajectory,
                    [=](const StampedPose& pose) { return pose.T_map_sensor.translation()[axis]; });
  };
  const auto rotation_deg = [&](int axis) {
    return of_poses(trajectory, [=](const StampedPose& pose) {
      return kDegreesPerRadian * roll_pitch_yaw_rad(pose.T_map_sensor)[axis];
    });
  };
  const std::vector<slam::Status> kinds = statuses();
  Json scan = Json::array();
  std::vector<std::uint8_t> gap;
  std::vector<std::uint8_t> mapping;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    scan.push_back(run.scans[i].scan);
    gap.push_back(i + 1 < trajectory.size() && !is_motion_known(run, i) ? 1 : 0);
    const auto kind = std::ranges::find(kinds, run.scans[i].report.mapping_status);
    mapping.push_back(static_cast<std::uint8_t>(kind - kinds.begin()));
  }
  Json json = {
      {"scan", std::move(scan)},
      {"time_s", of_poses(trajectory, [=](const auto& pose) { return pose.stamp_s - stamp_s; })},
      {"x", position_m(0)},
      {"y", position_m(1)},
      {"z", position_m(2)},
      {"roll_deg", rotation_deg(0)},
      {"pitch_deg", rotation_deg(1)},
      {"yaw_deg", rotation_deg(2)},
      {"gap", u8_block(gap)},
      {"mapping", u8_block(mapping)}};
  json["sigma"] = sigmas_json(run);
  if (!run.comparison) return json;
  const AbsolutePoseError& error = run.comparison->error;
  std::vector<float> error_m(trajectory.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < error.translation_m.size(); ++i) {
    error_m[error.pairs.estimate[i]] = static_cast<float>(error.translation_m[i]);
  }
  json["error_m"] = f32_block(error_m);
  json["largest_error_m"] = error.translation_statistics.max;
  return json;
}

/// The reference in the map frame: the alignment moved the estimate onto the reference, and its
/// inverse brings the reference here.
Json reference_json(const SlamRun& run) {
  const Pose T_map_reference =
      run.trajectory.front().T_map_sensor *
      run.comparison->error.aligned_estimate.front().T_map_sensor.inverse();
  const auto position_m = [&](int axis) {
    return of_poses(run.comparison->reference, [&](const StampedPose& pose) {
      return (T_map_reference * pose.T_map_sensor).translation()[axis];
    });
  };
  return {{"x", position_m(0)}, {"y", position_m(1)}};
}

/// unit: how many of the row's are one of the error's; nothing: the error is not known.
Json error_row(const char* name, const Statistics& error, std::optional<double> unit,
               int decimals) {
  Json cells = {name};
  for (const double value : {error.rmse, error.mean, error.median, error.max}) {
    cells.push_back(figure_text(unit ? std::optional(*unit * value) : std::nullopt, decimals));
  }
  return cells;
}

Json error_json(const SlamRun& run) {
  const AbsolutePoseError& error = run.comparison->error;
  std::vector<double> times_s;
  for (const std::size_t pose : error.pairs.estimate) {
    times_s.push_back(run.trajectory[pose].stamp_s - run.trajectory.front().stamp_s);
  }
  return {
      {"reference", run.comparison->reference_path},
      {"time_s", f32_block(times_s)},
      {"translation_m", f32_block(error.translation_m)},
      {"rows",
       {error_row("position, m", error.translation_statistics, 1.0, 3),
        error_row(error.is_rotation_known ? "rotation, degrees"
                                          : "rotation: not determined by so straight a path",
                  error.rotation_statistics,
                  error.is_rotation_known ? std::optional(kDegreesPerRadian) : std::nullopt, 2)}}};
}

Json statuses_json(const SlamRun& run) {
  Json json = {{"names", Json::array()}, {"odometry", Json::array()}, {"mapping", Json::array()}};
  for (const auto& [kind, scans] : status_counts(run, &slam::ScanReport::odometry_status)) {
    json["names"].push_back(slam::name(kind));
    json["odometry"].push_back(scans);
  }
  for (const auto& [kind, scans] : status_counts(run, &slam::ScanReport::mapping_status)) {
    json["mapping"].push_back(scans);
  }
  return json;
}

}  // namespace

Json report_json(const SlamRun& run, const DenseMapRun* dense_map, const slam::OccupancyMap* grid) {
  const std::string upsampled =
      run.upsampled_by.empty() ? "" : fmt::format(", upsampled by {}", run.upsampled_by);
  std::string subtitle = fmt::format("hqslam {}, sensor {}, range images of {} x {}", run.command,
                                     run.sensor.name, run.sensor.rows(), run.sensor.columns);
  if (dense_map != nullptr) {
    subtitle += fmt::format(
        "; dense map of {} points, one per voxel of {} m, from {} scans: measured points, and "
        "computed ones where scans agree",
        dense_map->points.size(), dense_map->voxel_m, dense_map->scans);
  }
  TurningView view = view_of(run, dense_map);
  if (grid != nullptr) view.grid = {*grid, run.occupancy_grid_summary};
  Json data = {
      {"command", run.command},
      {"title", fmt::format("{}, {} rows{}", short_name(run.input), run.sensor.rows(), upsampled)},
      {"subtitle", subtitle},
      {"command_line", invocation()},
      {"date", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)))},
      {"notices", notices_json(run)},
      {"numbers", numbers_json(run)},
      {"view", turning_view_json(view)},
      {"trajectory", trajectory_json(run)},
      {"statuses", statuses_json(run)},
      {"times", Json::array()},
      {"slam_ms", f32_block(slam_times(run).times_ms)}};
  for (const ScanTimes& stage : stage_times(run)) {
    data["times"].push_back({{"name", stage.name}, {"ms", f32_block(stage.times_ms)}});
  }
  if (run.comparison && !run.trajectory.empty()) {
    data["reference"] = reference_json(run);
    data["error"] = error_json(run);
  }
  return data;
}

std::string report_html(const SlamRun& run, const DenseMapRun* dense_map,
                        const slam::OccupancyMap* grid) {
  return page_html("report", report_json(run, dense_map, grid));
}

}  // namespace hqslam::tools
