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

/// Of a list of values (errors, durations), in their unit; all 0 for an empty list.
struct Statistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;  ///< the smallest value that at least 95 % of the list do not exceed
  double max = 0.0;
};
Statistics statistics_of(std::vector<double> values);

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
  Trajectory aligned_estimate;        ///< the whole estimate, in the reference's frame
  std::vector<double> translation_m;  ///< per pair
  std::vector<double> rotation_rad;   ///< per pair
  Statistics translation_statistics;  ///< metres
  Statistics rotation_statistics;     ///< radians
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
  Statistics translation_statistics;
  Statistics rotation_statistics;
};
/// Stretches start at every pair from which the path is long enough; none gives empty statistics.
RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                      double stretch_m, double max_difference_s = 0.02);

/// A stretch of a drive over which tracking was lost: the scans of consecutive windows of
/// kSlipScans whose motion is wrong by more than kSlip_m or kSlip_rad.
struct Slip {
  std::size_t first = 0;       ///< index into the reference
  std::size_t last = 0;        ///< index of the last pose, included
  double translation_m = 0.0;  ///< largest error of a window
  double rotation_rad = 0.0;   ///< largest error of a window
};

inline constexpr std::size_t kSlipScans = 10;  ///< steps from a window's first pose to its last
inline constexpr double kSlip_m = 0.3;
inline constexpr double kSlip_rad = 0.005235987755982988;  ///< 0.3 degrees

/// Finds where an odometry loses track, as opposed to drifting by a little everywhere.
///
/// In: an estimate with one pose per scan, and the true trajectory, paired by their stamps; frames
/// and rates need not agree. Out: the slips, in the order of time. For each scan i with i + n, n =
/// kSlipScans, both with a true pose, the window's error is
///   E = (T_ref_i^-1 T_ref_i+n)^-1 (T_est_i^-1 T_est_i+n)
/// It counts if |t(E)| > kSlip_m or angle(E) > kSlip_rad. Windows that share a scan, or
/// whose scans follow one another, make one slip: a jump within one scan spoils n windows and is
/// one slip, and so is a kilometre of lost tracking. A scan without a true pose spoils no
/// window. Throws Error if fewer than 2 poses can be paired.
std::vector<Slip> slips(const Trajectory& estimate, const Trajectory& reference,
                        double max_difference_s = 0.02);

/// Slips per 100 km of path; 0 where there is no path.
double slips_per_100_km(std::size_t slips, double path_m);

/// Means over pieces of path, as KITTI's odometry benchmark takes them (Geiger et al., CVPR 2012),
/// but of one length, and with a piece starting at every pose instead of every tenth.
struct Drift {
  std::size_t pieces = 0;  ///< none: the path is shorter than a piece, or slips are everywhere
  double translation_percent = 0.0;
  double rotation_deg_per_100m = 0.0;
};
inline constexpr double kDriftPiece_m = 100.0;

/// `error`: relative_pose_error over pieces of its length. Pieces that share a scan with one of
/// `left_out` do not count: what is left is how an estimate drifts where it does not slip.
Drift drift(const RelativePoseError& error, const std::vector<Slip>& left_out = {});

}  // namespace hqslam
