#pragma once

#include <optional>
#include <vector>

#include "published_features.h"
#include "published_step.h"

namespace hqslam::slam::as_published {

/// Points in the order of their rows.
struct RowPoints {
  std::vector<Eigen::Vector3f> points_m;
  std::vector<int> rows;
};

/// The scan before, as the odometry matches with it: in the sensor's frame at the end of its sweep.
struct LastScan {
  RowPoints edges;
  RowPoints surfaces;
};

/// LeGO-LOAM's feature association, second half: the motion over a sweep.
///
/// The motion (R, t) takes points from the end of the sweep to its start; a point at the fraction s
/// of the sweep is moved by R(s roll, s pitch, s yaw) and s t. Step 1 matches flat points with the
/// last scan's less flat ones and estimates roll, pitch and z; step 2 matches sharp edges with the
/// last less sharp ones and estimates yaw, x and y. Each makes up to 25 steps of 5 % of a
/// Gauss-Newton step, so at most 72 % of the way, and looks for neighbours in every fifth. The
/// second and third neighbour are looked for upwards in the last scan only as far as the scan has
/// features: of the last scan's rows that is the lowest few. The estimate starts from the last
/// motion.
class PublishedOdometry {
 public:
  explicit PublishedOdometry(double scan_period_s) : scan_period_s_(scan_period_s) {}

  /// Moves on by one sweep. The first scan is only remembered.
  void add(const PublishedFeatures& features);

  /// Whether there was a scan before the last.
  bool has_motion() const { return has_motion_; }
  /// From the end of the sweep to its start.
  const Parameters& motion() const { return motion_; }
  /// At the end of the last sweep, in the frame of the end of the first.
  const Pose& T_odom_end() const { return T_odom_end_; }
  const LastScan& last() const { return *last_; }

 private:
  Eigen::Vector3d at_start(const FeaturePoint& point) const;
  void match(const std::vector<FeaturePoint>& features, const RowPoints& target, bool with_planes);
  LastScan at_end(const PublishedFeatures& features) const;

  double scan_period_s_;
  bool has_motion_ = false;
  Parameters motion_ = Parameters::Zero();
  Pose T_odom_end_ = Pose::Identity();
  std::optional<LastScan> last_;  ///< from the first scan on
};

}  // namespace hqslam::slam::as_published
