#include "recording/reference.h"

#include "hqslam/core/error.h"

namespace hqslam::tools {

Trajectory with_stamps_of(const TrajectoryFile& file, const Trajectory& other) {
  if (file.has_stamps) return file.poses;
  if (file.poses.size() != other.size()) {
    throw Error(
        "{}: has {} poses without stamps, expected as many as those they are compared with, found "
        "{}; give a pose of the same scans each, or TUM files",
        file.path, file.poses.size(), other.size());
  }
  Trajectory stamped = file.poses;
  for (std::size_t i = 0; i < stamped.size(); ++i) stamped[i].stamp_s = other[i].stamp_s;
  return stamped;
}

Trajectory with_stamps_of_scans(const TrajectoryFile& file, const Trajectory& other,
                                const std::vector<std::int64_t>& scan_of_pose) {
  if (file.has_stamps) return file.poses;
  Trajectory stamped;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const auto scan = static_cast<std::size_t>(scan_of_pose[i]);
    if (scan >= file.poses.size()) break;
    stamped.push_back({other[i].stamp_s, file.poses[scan].T_map_sensor});
  }
  return stamped;
}

std::optional<ReferenceComparison> compare_with_reference(const Trajectory& estimate,
                                                          const TrajectoryFile& reference) {
  constexpr std::size_t kFewestPairs = 3;
  ReferenceComparison comparison;
  comparison.reference_path = reference.path;
  const Trajectory stamped = with_stamps_of(reference, estimate);
  if (associate(estimate, stamped, kMaxStampDifference_s).estimate.size() < kFewestPairs) {
    return std::nullopt;
  }
  comparison.error = absolute_pose_error(estimate, stamped, Alignment::kSe3, kMaxStampDifference_s);
  for (const std::size_t index : comparison.error.pairs.reference) {
    comparison.reference.push_back(stamped[index]);
  }
  return comparison;
}

}  // namespace hqslam::tools
