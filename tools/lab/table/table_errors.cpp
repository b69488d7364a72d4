#include "table/table_errors.h"

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

}  // namespace hqslam::tools
