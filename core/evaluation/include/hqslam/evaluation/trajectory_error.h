#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "hqslam/core/trajectory.h"

namespace hqslam {

/// How an estimate is moved onto the reference before errors are taken.
enum class Alignment {
  kNone,
  kFirstPose,  ///< first poses made equal
  kSe3,        ///< least-squares rotation and translation of all positions (Umeyama, no scale)
};
std::string_view name(Alignment alignment);  ///< "none", "first", "se3"
Alignment alignment_from_name(std::string_view name);

struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
};
ErrorStatistics statistics_of(std::vector<double> values);

/// Pairs of poses with equal stamps, as indices into the two trajectories.
struct PosePairs {
  std::vector<std::size_t> estimate;
  std::vector<std::size_t> reference;
};
/// Nearest stamps, at most max_difference_s apart, each reference pose used once.
PosePairs associate(const Trajectory& estimate, const Trajectory& reference,
                    double max_difference_s);

/// Absolute pose error (evo's APE): per pair E = T_ref^-1 T_est after alignment.
struct AbsolutePoseError {
  Alignment alignment = Alignment::kSe3;
  PosePairs pairs;
  Trajectory aligned_estimate;             ///< the whole estimate, in the reference's frame
  std::vector<double> translation_m;       ///< per pair
  std::vector<double> rotation_rad;        ///< per pair
  ErrorStatistics translation_statistics;  ///< metres
  ErrorStatistics rotation_statistics;     ///< radians
  /// False: the path is so straight that kSe3 turns the estimate about it by errors of positions
  /// (by more than a degree, one standard deviation); rotation_rad then has that turn.
  bool is_rotation_known = true;
};
/// Throws Error if fewer than 2 pairs (3 for kSe3) can be made.
AbsolutePoseError absolute_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                      Alignment alignment, double max_difference_s = 0.02);

/// Relative pose error over stretches of a given length of path along the reference; drift.
struct RelativePoseError {
  double stretch_m = 0.0;
  std::vector<std::size_t> first;     ///< per stretch, where it begins: index into the reference
  std::vector<std::size_t> last;      ///< per stretch, where it ends: index into the reference
  std::vector<double> translation_m;  ///< per stretch, not divided by its length
  std::vector<double> rotation_rad;
  ErrorStatistics translation_statistics;
  ErrorStatistics rotation_statistics;
};
/// Stretches start at every pair from which the path is long enough; none gives empty statistics.
RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                      double stretch_m, double max_difference_s = 0.02);

}  // namespace hqslam
