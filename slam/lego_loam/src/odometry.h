#pragma once

#include <optional>

#include "feature_extraction.h"
#include "registration.h"

namespace hqslam::lego_loam {

struct OdometryResult {
  bool has_motion = false;             ///< not for the first scan
  PoseParameters motion;               ///< T_start_end of the last sweep
  Pose T_odom_end = Pose::Identity();  ///< in the frame of the end of the first sweep
  int planes = 0;                      ///< correspondences of the last search; 0: too few
  int edges = 0;
};

/// Section III-D. In: the features of scan after scan. Out: the motion over each sweep.
///
/// Step 1 matches flat points with planes through three of the last scan's less flat points and
/// estimates z, roll and pitch; step 2 matches sharp points with lines through two of its less
/// sharp points and estimates x, y and yaw. Both are Levenberg-Marquardt on the distances. From the
/// second of at most five searches on, distances d are weighted by 1 - 1.8 d (lines) or
/// 1 - 1.8 d / sqrt(range) (planes), and those below 0.1 left out. Correspondences have equal
/// labels: flat points, which are ground, are matched with ground; edges, which are none, with
/// clusters. The start is the motion over the last sweep.
///
/// The motion is taken as steady: a point captured s sweeps after the point that it is matched with
/// is moved by R(s) p + s t.
///
/// Differs from LeGO-LOAM: its program, as LOAM, matches with the last scan's points as moved to
/// the end of their sweep by the last estimate, and s counts from there. An error in that estimate
/// comes back, multiplied by up to (1 - s) / s, and Levenberg-Marquardt diverges where edges stand
/// early in the sweep. The program hides this with 25 steps of 5 % of a Gauss-Newton step, which
/// leave 28 % of the last estimate, and by a slip in its times (the first quarter of all rows but
/// one counts as after the end). It also looks for the second and third neighbour only among as
/// many of the last points as the scan has features, matches flat points with clusters too, and
/// leaves out directions whose eigenvalue is below 10.
class Odometry {
 public:
  /// Moves on by one sweep; the first scan is the reference only.
  const OdometryResult& add(const Features& features);

 private:
  OdometryResult result_;
  std::optional<SearchCloud> last_edges_;
  std::optional<SearchCloud> last_ground_;
};

/// Points of a scan, moved to the end of its sweep.
Cloud at_sweep_end(const Cloud& cloud, const PoseParameters& motion);

}  // namespace hqslam::lego_loam
