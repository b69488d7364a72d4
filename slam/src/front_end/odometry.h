#pragma once

#include "front_end/features.h"
#include "front_end/motion_correction.h"
#include "front_end/row_ordered_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/slam/status.h"

namespace hqslam::slam {

/// Features of a scan, of either kind, with which the next one can be matched; as in LeGO-LOAM.
inline constexpr int kFewestEdges = 10;
inline constexpr int kFewestPlanar = 100;

/// The ground and edges of a scan, corrected for motion, with which the next scan is matched.
struct OdometryTarget {
  RowOrderedCloud ground;
  RowOrderedCloud edges;

  OdometryTarget(const Features& features, const ScanMotion& motion);
};

struct PredictedMotion {
  Pose T_reference_sensor = Pose::Identity();
  double duration_s = 0.0;  ///< from the reference's stamp to the scan's
};

struct OdometryResult {
  Pose T_reference_sensor = Pose::Identity();
  Status status = Status::kOk;
  int planar_correspondences = 0;
  int edge_correspondences = 0;
};

/// Scan-to-scan motion in two steps, for scans that mapping does not locate from the prediction.
///
/// In: a reference scan, features of a scan (as measured), its predicted motion. Out: the
/// sensor's pose in the frame of the reference scan at its stamp. Step 1 matches flat points of the
/// ground with planes of the reference's ground and estimates z, roll, pitch; step 2 matches sharp
/// edges with lines through the reference's edges and estimates x, y, yaw, both by
/// Levenberg-Marquardt. The scan is corrected for the motion found so far before each search.
/// Source: LeGO-LOAM, section 4 C of its paper.
///
/// Differs from LeGO-LOAM: all of the reference is searched, not as many of its points as the scan
/// has features; 8 searches of full LM steps, not 25 of 5 % of a Gauss-Newton step; the two steps
/// alternate until both converge; ground is matched with ground and edges with edges, as in its
/// paper; a direction that is not observable keeps its predicted value; without ground (indoors,
/// close to the floor) edges estimate all six parameters, as far as they can; with too few edges
/// the status is kTooFewFeatures and the result of the ground alone or of the wide searches stands.
OdometryResult scan_to_scan(const OdometryTarget& reference, const Features& features,
                            const PredictedMotion& predicted);

}  // namespace hqslam::slam
