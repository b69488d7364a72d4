#include "recording/reference.h"

#include <fmt/format.h>

#include <algorithm>

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
  comparison.units = complaint_about_units(estimate, stamped, comparison.error.pairs);
  for (const std::size_t index : comparison.error.pairs.reference) {
    comparison.reference.push_back(stamped[index]);
  }
  return comparison;
}

std::string complaint_about_units(const Trajectory& estimate, const Trajectory& reference,
                                  const PosePairs& pairs) {
  constexpr double kFewestTimes = 50.0;  // between those of metres in centimetres and of errors
  const auto path_of = [](const Trajectory& poses, const std::vector<std::size_t>& paired) {
    double path = 0.0;
    for (std::size_t i = 1; i < paired.size(); ++i) {
      path += (poses[paired[i]].T_map_sensor.translation() -
               poses[paired[i - 1]].T_map_sensor.translation())
                  .norm();
    }
    return path;
  };
  const double of_estimate = path_of(estimate, pairs.estimate);
  const double of_reference = path_of(reference, pairs.reference);
  const auto [shorter, longer] = std::minmax(of_estimate, of_reference);
  if (shorter < 1.0 || longer < kFewestTimes * shorter) return "";
  const bool is_reference = of_reference > of_estimate;
  return fmt::format("the {}'s path is {:.0f} times as long as the {}'s; millimetres?",
                     is_reference ? "reference" : "estimate", longer / shorter,
                     is_reference ? "estimate" : "reference");
}

}  // namespace hqslam::tools
