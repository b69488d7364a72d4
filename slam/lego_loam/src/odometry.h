#pragma once

#include <pcl/kdtree/kdtree_flann.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "feature_extraction.h"
#include "hqslam/core/pose.h"

namespace hqslam::lego_loam {

/// The motion over a sweep, T_start_end, split as the two steps split it:
///   R = Rz(yaw) Ry(pitch) Rx(roll),  t = (x, y, z).
/// A point captured at the fraction s of the sweep is moved to the begin by R(s roll, s pitch, s
/// yaw) and s t: the motion is taken as steady.
struct SweepMotion {
  Eigen::Vector3d out_of_plane = Eigen::Vector3d::Zero();  ///< z [m], roll, pitch [rad]: step 1
  Eigen::Vector3d in_plane = Eigen::Vector3d::Zero();      ///< x, y [m], yaw [rad]: step 2
};
/// At the fraction s of the sweep.
Pose pose_of(const SweepMotion& motion, double s = 1.0);

/// Points of the last scan that features are matched with, with a kd-tree for each row and one for
/// all.
class RowTrees {
 public:
  explicit RowTrees(const Cloud& cloud);
  std::size_t size() const { return cloud_->size(); }

  /// All within 5 m of p. The nearest point, and the nearest one in the two rows above and below
  /// it.
  struct Line {
    Point nearest;
    Point other_row;
  };
  std::optional<Line> line_at(const Point& p) const;
  /// As above, and the second nearest in the row of the nearest.
  struct Plane {
    Point nearest;
    Point same_row;
    Point other_row;
  };
  std::optional<Plane> plane_at(const Point& p) const;

 private:
  std::optional<Point> nearest(const Point& p) const;
  std::optional<Point> nearest_in_row(int row, const Point& p, int rank) const;
  std::optional<Point> nearest_beside(int row, const Point& p) const;

  Cloud::Ptr cloud_;
  pcl::KdTreeFLANN<Point> tree_;
  std::vector<Cloud::Ptr> row_cloud_;
  std::vector<pcl::KdTreeFLANN<Point>> row_tree_;
};

/// Section III-D. In: the features of scan after scan. Out: the motion over each sweep.
///
/// Step 1 matches flat points with planes of the last scan's less flat points and estimates z, roll
/// and pitch; step 2 matches sharp points with lines of its less sharp points and estimates x, y
/// and yaw, the others held. Both are Levenberg-Marquardt (Ceres) on distances
///   d = n . (p - q)  from a plane,   d = |(p - q) x u|  from a line,
/// p a point moved to the begin of the sweep, where the last scan's points are too. Correspondences
/// are searched up to five times; from the second search on they are weighted by 1 - 1.8 d (edges)
/// or 1 - 1.8 d / sqrt(range) (planes), and below 0.1 left out. Correspondences have equal labels:
/// flat points, which are ground, are matched with ground, edges, which are none, with clusters.
/// The search starts from the motion over the last sweep.
///
/// Differs from LeGO-LOAM: the program makes 25 steps of 5 % of a Gauss-Newton step in place of
/// Levenberg-Marquardt, which leave 28 % of what was wrong at the start; looks for the second and
/// third neighbour only among as many of the last scan's points as the scan has features; matches
/// flat points with clusters too; and leaves out directions whose eigenvalue is below 10.
class Odometry {
 public:
  /// Moves on by one sweep; the first scan becomes the reference only.
  void add(const Features& features);

  bool has_motion() const { return has_motion_; }
  const SweepMotion& motion() const { return motion_; }
  /// At the end of the last sweep, in the frame of the end of the first.
  const Pose& T_odom_end() const { return T_odom_end_; }
  int planes() const { return planes_; }  ///< correspondences of the last search; 0: too few
  int edges() const { return edges_; }

  /// Points of the last scan, moved to the end of its sweep.
  Cloud at_sweep_end(const Cloud& cloud) const;

 private:
  int match_planes(const Cloud& flat);
  int match_edges(const Cloud& sharp);

  bool has_motion_ = false;
  SweepMotion motion_;
  Pose T_odom_end_ = Pose::Identity();
  int planes_ = 0;
  int edges_ = 0;
  std::optional<RowTrees> edge_target_;
  std::optional<RowTrees> ground_target_;
};

}  // namespace hqslam::lego_loam
