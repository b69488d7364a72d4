#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/evaluation/trajectory_error.h"

namespace hqslam {

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
