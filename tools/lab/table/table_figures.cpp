#include "table/table_figures.h"

#include "hqslam/core/angles.h"
#include "recording/reference.h"

namespace hqslam::tools {
namespace {

void add_errors(const TableResult* all_rows, const std::optional<TrajectoryFile>& truth,
                TableResult& result) {
  for (std::size_t i = 0; i < result.trajectory.size(); ++i) {
    const Trajectory& trajectory = result.trajectory[i];
    if (all_rows != nullptr && !is_reference(result.method)) {
      result.against_all_rows[i] = error_figures(trajectory, all_rows->trajectory[i]);
    }
    if (!truth) continue;
    const Trajectory stamped = with_stamps_of_scans(*truth, trajectory, result.scan_of_pose);
    result.against_truth[i] = error_figures(trajectory, stamped);
    if (i == kLoopClosingOff && result.against_truth[i]) result.slips = slips(trajectory, stamped);
  }
}

}  // namespace

std::optional<ErrorFigures> error_figures(const Trajectory& estimate, const Trajectory& reference) {
  std::optional<ReferenceComparison> comparison =
      compare_with_reference(estimate, {"", reference, true});
  if (!comparison) return std::nullopt;
  ErrorFigures figures;
  figures.ape = std::move(comparison->error);
  figures.path_m = path_length_m(comparison->reference);
  figures.pieces = relative_pose_error(estimate, reference, kDriftPiece_m);
  return figures;
}

std::optional<double> ErrorFigures::rpe_percent() const {
  if (pieces.translation_m.empty()) return std::nullopt;
  return 100.0 / kDriftPiece_m * pieces.translation_statistics.rmse;
}

std::optional<double> ErrorFigures::rpe_deg_per_100m() const {
  if (pieces.translation_m.empty()) return std::nullopt;
  return 100.0 / kDriftPiece_m * kDegreesPerRadian * pieces.rotation_statistics.rmse;
}

std::optional<double> TableResult::upsampling_fps() const {
  if (method.source.empty()) return std::nullopt;
  return 1e3 / timings.upsampling_ms;
}

double TableResult::chain_fps(std::size_t loop_closing) const {
  return static_cast<double>(trajectory[kLoopClosingOff].size()) /
         (timings.upsampling_s + timings.points_s + timings.slam[loop_closing].total_s);
}

double TableResult::slam_ms() const {
  return 1e3 * timings.slam[kLoopClosingOff].total_s /
         static_cast<double>(trajectory[kLoopClosingOff].size());
}

DriveFigures drive_figures(const TableDrive& drive, const std::string& sensor,
                           std::vector<TableResult> results,
                           const std::optional<TrajectoryFile>& truth) {
  DriveFigures figures;
  figures.name = drive.name;
  if (drive.simulated) {
    figures.kind = drive.simulated->name;
    figures.seed = drive.simulated->seed;
  }
  figures.sensor = sensor;
  figures.truth = truth ? truth->path : "";
  figures.methods = std::move(results);
  const TableResult* all_rows = nullptr;
  for (const TableResult& result : figures.methods) {
    figures.scans = result.settings.scans;
    if (result.left_out.scans > figures.left_out.scans) figures.left_out = result.left_out;
    if (is_reference(result.method)) all_rows = &result;
  }
  for (TableResult& result : figures.methods) add_errors(all_rows, truth, result);
  return figures;
}

const TableResult* find_method(const DriveFigures& drive, const std::string& name) {
  for (const TableResult& result : drive.methods) {
    if (result.method.name == name) return &result;
  }
  return nullptr;
}

}  // namespace hqslam::tools
