#include "loops/pose_graph.h"

#include "slam/poses.h"

using namespace hqslam::slam;

namespace {

constexpr double kSide_m = 10.0;
constexpr int kEdgesPerSide = 10;

/// Along a square and back to its beginning, node by node.
std::vector<Pose> square() {
  std::vector<Pose> poses = {Pose::Identity()};
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kEdgesPerSide; ++i) {
      const bool turns = i == kEdgesPerSide - 1;
      poses.push_back(poses.back() * pose_from_xyz_rpy({kSide_m / kEdgesPerSide, 0.0, 0.0}, 0.0,
                                                       0.0, turns ? std::numbers::pi / 2 : 0.0));
    }
  }
  return poses;
}

/// The square as an odometry would give it that adds `drift` to every step.
PoseGraph drifted_square(const Pose& drift) {
  const std::vector<Pose> truth = square();
  PoseGraph graph;
  graph.T_map_node.push_back(truth.front());
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    const Pose step = truth[i].inverse() * truth[i + 1] * drift;
    graph.odometry.push_back({i, i + 1, step, 0.05, 0.005});
    graph.T_map_node.push_back(graph.T_map_node.back() * step);
  }
  return graph;
}

}  // namespace

TEST_CASE("a gap in a straight path is spread evenly over its edges") {
  // Five steps of 1 m; the loop has the last node at 5.5 m. By hand: n edges of variance
  // v and a loop of variance w leave the loop w / (n v + w) of the gap, each edge v / (n v + w).
  PoseGraph graph;
  graph.T_map_node.push_back(Pose::Identity());
  for (std::size_t i = 0; i < 5; ++i) {
    graph.odometry.push_back({i, i + 1, at_x(1.0), 0.2, 0.01});
    graph.T_map_node.push_back(graph.T_map_node.back() * at_x(1.0));
  }
  graph.loops.push_back({0, 5, at_x(5.5), 0.01, 0.01});
  const std::vector<Pose> poses = optimized(graph);
  REQUIRE(poses.size() == 6);
  for (int i = 0; i <= 5; ++i) {
    CHECK(poses[i].translation().x() ==
          doctest::Approx(i * (1.0 + 0.5 * 0.04 / 0.2001)).epsilon(1e-4));
    CHECK(rotation_angle_rad(poses[i]) < 1e-6);
  }
}

TEST_CASE("a square whose odometry drifts closes with one loop") {
  const PoseGraph open = drifted_square(pose_from_xyz_rpy({0.01, 0.0, 0.02}, 0.0, 0.0, 0.004));
  const std::vector<Pose> truth = square();
  const double before_m = worst_error_m(open.T_map_node, truth);
  CHECK(before_m > 1.3);
  PoseGraph closed = open;
  closed.loops.push_back({0, 40, Pose::Identity(), 0.01, 0.001});
  const std::vector<Pose> poses = optimized(closed);
  REQUIRE(poses.size() == truth.size());
  CHECK((poses.back().translation() - truth.back().translation()).norm() < 0.02);
  CHECK(worst_error_m(poses, truth) < before_m / 5.0);
  CHECK(poses.front().matrix() == truth.front().matrix());
}

TEST_CASE("a gap far beyond the reach of the robust loss is closed") {
  // 4 m over 40 edges of 5 cm: 400 times the loop's sigma.
  const PoseGraph open = drifted_square(pose_from_xyz_rpy({0.0, 0.0, 0.1}, 0.0, 0.0, 0.0));
  PoseGraph closed = open;
  closed.loops.push_back({0, 40, Pose::Identity(), 0.01, 0.001});
  const std::vector<Pose> poses = optimized(closed);
  REQUIRE(poses.size() == 41);
  CHECK(open.T_map_node.back().translation().z() == doctest::Approx(4.0));
  CHECK(poses.back().translation().norm() < 0.02);
}

TEST_CASE("a path that drifts always to the same side is closed by loops that agree") {
  // Every edge turns by three of its sigmas, always to the left. That many sigmas would pay for
  // letting the loops go.
  const PoseGraph open = drifted_square(pose_from_xyz_rpy({0.0, 0.0, 0.0}, 0.0, 0.0, 0.015));
  const std::vector<Pose> truth = square();
  PoseGraph closed = open;
  const std::size_t last = truth.size() - 1;
  for (const std::size_t back : {0, 1, 2}) {
    closed.loops.push_back({0, last - back, truth[0].inverse() * truth[last - back], 0.1, 0.01});
  }
  const auto gap_m = [&](const std::vector<Pose>& poses) {
    return (poses[last].translation() - truth[last].translation()).norm();
  };
  CHECK(gap_m(open.T_map_node) > 3.0);
  CHECK(gap_m(optimized(closed)) < 0.1);
}

TEST_CASE("a false loop does not bend a path that true loops hold") {
  PoseGraph graph = drifted_square(Pose::Identity());
  for (const std::size_t i : {0, 2, 4, 6}) {
    // Along the first side twice: the true loops determine the second pass.
    graph.loops.push_back({i, 40, square()[i].inverse() * square()[40], 0.1, 0.005});
  }
  const std::vector<Pose> truth = square();
  CHECK(worst_error_m(optimized(graph), truth) < 1e-6);
  const Pose false_loop(Eigen::Translation3d(6.0, -3.0, 0.0));
  graph.loops.push_back({5, 25, false_loop, 0.1, 0.005});
  const std::vector<Pose> poses = optimized(graph);
  REQUIRE(poses.size() == truth.size());
  CHECK(worst_error_m(poses, truth) < 0.1);
  CHECK(slam::disagreement(graph.loops.back(), poses).translation().norm() > 5.0);
}

TEST_CASE("a graph without loops stays as it is, and one without nodes gives none") {
  const PoseGraph graph = drifted_square(pose_from_xyz_rpy({0.01, 0.0, 0.0}, 0.0, 0.0, 0.004));
  CHECK(worst_error_m(optimized(graph), graph.T_map_node) < 1e-9);
  CHECK(optimized(PoseGraph{}).empty());
}
