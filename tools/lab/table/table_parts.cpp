#include "table/table_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recording/reference.h"

namespace hqslam::tools {

std::optional<TrajectoryErrors> trajectory_errors(const Trajectory& estimate,
                                                  const Trajectory& reference) {
  const auto comparison = compare_with_reference(estimate, {"", reference, true});
  if (!comparison) return std::nullopt;
  return TrajectoryErrors{
      comparison->error.translation_statistics.rmse, path_length_m(comparison->reference),
      relative_pose_error(estimate, reference, kDriftPiece_m), slips(estimate, reference)};
}

namespace {

/// Errors of all methods; nothing where one of them has none.
std::optional<DriveErrors> errors_of(const FinishedDrive& finished, const Trajectory& reference) {
  const TableDrive& drive = finished.drive;
  DriveErrors errors{.kind = drive.name, .scans = finished.scans};
  if (drive.simulated) {
    errors.kind = drive.simulated->name;
    errors.seed = drive.simulated->seed;
  }
  for (const Trajectory& trajectory : finished.trajectories) {
    auto of_method = trajectory_errors(trajectory, reference);
    if (!of_method) return std::nullopt;
    errors.methods.push_back(std::move(*of_method));
    errors.scans_left_out =
        std::max(errors.scans_left_out, finished.scans - std::ssize(trajectory));
  }
  return errors;
}

double to_millimetre(double length_m) { return 1e-3 * std::round(1e3 * length_m); }

void add_place(const StampedPose& pose, std::vector<double>& x_m, std::vector<double>& y_m) {
  x_m.push_back(to_millimetre(pose.T_map_sensor.translation().x()));
  y_m.push_back(to_millimetre(pose.T_map_sensor.translation().y()));
}

/// Every how many poses are kept.
std::size_t step_of(std::size_t poses) { return (poses + kMostPathPoses - 1) / kMostPathPoses; }

ErrorPath path_of(const std::string& title, const ReferenceComparison& comparison) {
  const AbsolutePoseError& ape = comparison.error;
  ErrorPath path{title, ape.translation_statistics.rmse, {}, {}};
  const std::size_t poses = comparison.reference.size();
  const auto position_m = [&](std::size_t i) -> Eigen::Vector3d {
    return comparison.reference[i].T_map_sensor.translation();
  };
  double distance_m = 0.0;
  for (std::size_t i = 0; i < poses; ++i) {
    if (i > 0) distance_m += (position_m(i) - position_m(i - 1)).norm();
    if (i % step_of(poses) != 0) continue;
    add_place(ape.aligned_estimate[ape.pairs.estimate[i]], path.x_m, path.y_m);
    path.distance_m.push_back(to_millimetre(distance_m));
    path.error_m.push_back(to_millimetre(ape.translation_m[i]));
  }
  return path;
}

ErrorMap map_of(const TableSample& sample, const FinishedDrive& drive,
                const Trajectory& reference) {
  ErrorMap map;
  const std::size_t poses = std::min(reference.size(), drive.trajectories.front().size());
  for (std::size_t i = 0; i < poses; i += step_of(poses)) {
    add_place(reference[i], map.x_m, map.y_m);
  }
  for (std::size_t i = 0; i < sample.methods.size(); ++i) {
    if (&drive.trajectories[i] == &reference) continue;
    const auto comparison = compare_with_reference(drive.trajectories[i], {"", reference, true});
    map.paths.push_back(path_of(sample.methods[i].title, *comparison));
  }
  return map;
}

void add_drive(const TableSample& empty, const FinishedDrive& drive, const std::string& reference,
               const Trajectory& of_reference, std::vector<TablePart>& parts) {
  TableSample sample = empty;
  auto errors = errors_of(drive, of_reference);
  if (!errors) return;
  sample.drives.push_back(std::move(*errors));
  ErrorMap map = map_of(sample, drive, of_reference);
  parts.push_back({fmt::format("{} against {}", drive.drive.name, reference), reference,
                   std::move(sample), std::move(map)});
}

std::vector<TablePart> parts_over_seeds(TableSample sample,
                                        const std::vector<FinishedDrive>& drives) {
  for (const FinishedDrive& drive : drives) {
    if (auto errors = errors_of(drive, *drive.truth)) sample.drives.push_back(std::move(*errors));
  }
  const std::vector<std::string> kinds = kinds_of(sample);
  std::vector<TablePart> parts;
  if (kinds.size() > 1) parts.push_back({kAllDrives, "the truth", sample});
  for (const std::string& kind : kinds) parts.push_back({kind, "the truth", of_kind(sample, kind)});
  return parts;
}

}  // namespace

std::vector<TablePart> parts_of(const TablePlan& plan, const std::vector<FinishedDrive>& drives) {
  const TableSample empty{plan.methods, plan.against, {}};
  if (plan.over_seeds) return parts_over_seeds(empty, drives);
  std::vector<TablePart> parts;
  const auto all_rows = std::ranges::find(plan.methods, kAllRows, &TableMethod::name);
  for (const FinishedDrive& drive : drives) {
    if (drive.truth) add_drive(empty, drive, "the truth", *drive.truth, parts);
    if (all_rows == plan.methods.end()) continue;
    add_drive(empty, drive, all_rows->title,
              drive.trajectories[static_cast<std::size_t>(all_rows - plan.methods.begin())], parts);
  }
  return parts;
}

}  // namespace hqslam::tools
