#include "loops/loop_correction.h"

#include "slam/poses.h"

using slam::PoseGraph;

TEST_CASE("keyframes between two nodes are moved by their share of the path between them") {
  const std::vector<Pose> keyframes = {at_x(0), at_x(1), at_x(2), at_x(4), at_x(5)};
  // The second node, keyframe 3, is moved by 1 m to the left and turned.
  const Pose moved = pose_from_xyz_rpy({4.0, 1.0, 0.0}, 0.0, 0.0, 0.1);
  const std::vector<Pose> nodes = {at_x(0), moved};
  const auto result = slam::corrected_keyframes(keyframes, {0, 3}, nodes);
  REQUIRE(result.size() == 5);
  CHECK(result[0].matrix() == keyframes[0].matrix());
  CHECK(result[3].isApprox(moved, 1e-12));
  CHECK(result[4].isApprox(moved * at_x(1), 1e-12));
  // At a quarter of the path: interpolated between the poses by the first and the second node.
  // Between them a turn by 0.1 rad about a fixed point c, of which a quarter is made:
  // c = p + (d / 2 + z x d / (2 tan 0.05)) for a displacement d from p.
  const Eigen::Vector3d p_m = at_x(1).translation();
  const Eigen::Vector3d d_m = (moved * at_x(-3)).translation() - p_m;
  const Eigen::Vector3d aside_m = Eigen::Vector3d::UnitZ().cross(d_m);
  const Eigen::Vector3d centre_m = p_m + 0.5 * d_m + 0.5 / std::tan(0.05) * aside_m;
  const Eigen::AngleAxisd quarter(0.025, Eigen::Vector3d::UnitZ());
  CHECK((result[1].translation() - (centre_m + quarter * (p_m - centre_m))).norm() < 1e-12);
  CHECK(rotation_angle_rad(result[1]) == doctest::Approx(0.025));
}

TEST_CASE("keyframes that would hardly move stay exactly") {
  const std::vector<Pose> keyframes = {at_x(0), at_x(4), at_x(8)};
  const std::vector<Pose> nodes = {at_x(0), at_x(4.0005),
                                   pose_from_xyz_rpy({8.0, 0.5, 0.0}, 0, 0, 0)};
  const auto result = slam::corrected_keyframes(keyframes, {0, 1, 2}, nodes);
  CHECK(result[1].matrix() == keyframes[1].matrix());
  CHECK(result[2].translation().y() == doctest::Approx(0.5));
}

TEST_CASE("a correction is plausible if no edge is strained too much") {
  PoseGraph graph;
  graph.T_map_node = {at_x(0), at_x(4), at_x(8)};
  graph.odometry = {{0, 1, at_x(4), 0.1, 0.01}, {1, 2, at_x(4), 0.1, 0.01}};
  graph.loops = {{0, 2, at_x(8.3), 0.1, 0.01}};
  const std::vector<double> drift_m = {0.12, 0.12};
  CHECK(slam::is_plausible(graph, drift_m, {at_x(0), at_x(4.1), at_x(8.2)}));
  // One edge takes it all.
  CHECK(!slam::is_plausible(graph, drift_m, {at_x(0), at_x(4.0), at_x(8.4)}));
  // A turn that no odometry makes.
  CHECK(!slam::is_plausible(graph, drift_m,
                            {at_x(0), at_x(4.1), pose_from_xyz_rpy({8.2, 0, 0}, 0, 0, 0.1)}));
  // The loop is not met.
  graph.loops[0].T_from_to = at_x(9);
  CHECK(!slam::is_plausible(graph, drift_m, {at_x(0), at_x(4.1), at_x(8.2)}));
}
