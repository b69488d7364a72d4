#include "reference.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

constexpr int kTumColumns = 8;
constexpr std::size_t kFewestPairs = 3;

/// Number of values on the first line that is neither empty nor a comment.
int columns_of_first_line(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    std::string word;
    int columns = 0;
    while (words >> word && (columns > 0 || word.front() != '#')) {
      ++columns;
    }
    if (columns > 0) {
      return columns;
    }
  }
  return 0;
}

}  // namespace

TrajectoryFile read_trajectory_file(const std::string& path) {
  TrajectoryFile file;
  file.path = path;
  file.poses = read_trajectory(path);
  file.has_stamps = columns_of_first_line(path) == kTumColumns;
  return file;
}

Trajectory with_stamps_of(const TrajectoryFile& file, const Trajectory& other) {
  if (file.has_stamps) {
    return file.poses;
  }
  Trajectory stamped(
      file.poses.begin(),
      file.poses.begin() + static_cast<std::ptrdiff_t>(std::min(file.poses.size(), other.size())));
  for (std::size_t i = 0; i < stamped.size(); ++i) {
    stamped[i].stamp_s = other[i].stamp_s;
  }
  return stamped;
}

std::optional<ReferenceComparison> compare_with_reference(const Trajectory& estimate,
                                                          const TrajectoryFile& reference) {
  constexpr double kMaxStampDifference_s = 0.02;
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
