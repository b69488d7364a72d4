#include "loops/loop_candidates.h"

#include "slam/poses.h"
#include "slam/village.h"

using slam::PoseGraph;

namespace {

/// A straight path with a node every 4 m.
PoseGraph straight(int nodes) {
  PoseGraph graph;
  for (int i = 0; i < nodes; ++i) {
    graph.T_map_node.push_back(at_x(4.0 * i));
    if (i > 0) graph.odometry.push_back({graph.T_map_node.size() - 2, graph.T_map_node.size() - 1});
  }
  return graph;
}

}  // namespace

TEST_CASE("plausible drift grows along the path and is cut short by loops") {
  PoseGraph graph = straight(11);
  const std::vector<double> edge_drift_m(10, 0.5);
  const auto open = slam::plausible_drift(graph, edge_drift_m);
  for (int i = 0; i <= 10; ++i) {
    CHECK(open[i].translation_m - open[10].translation_m == doctest::Approx(0.5 * (10 - i)));
    CHECK(open[i].rotation_rad >= open[10].rotation_rad);
  }
  // Node 9 was recognized at node 1: from node 10 it is one edge and the loop to there.
  graph.loops.push_back({1, 9, Pose::Identity(), 0.1, 0.01});
  const auto tied = slam::plausible_drift(graph, edge_drift_m);
  CHECK(tied[1].translation_m - tied[10].translation_m == doctest::Approx(0.5 + 0.2));
  CHECK(tied[0].translation_m - tied[10].translation_m == doctest::Approx(1.0 + 0.2));
  CHECK(tied[5].translation_m - tied[10].translation_m == doctest::Approx(2.5));
  CHECK(tied[4].translation_m - tied[10].translation_m == doctest::Approx(0.5 + 0.2 + 1.5));
}

TEST_CASE("for unconnected nodes any drift is plausible") {
  PoseGraph graph = straight(4);
  graph.odometry.erase(graph.odometry.begin() + 1);  // tracking was lost after node 1
  const auto drift = slam::plausible_drift(graph, {0.5, 0.5});
  CHECK(std::isinf(drift[1].translation_m));
  CHECK(drift[1].rotation_rad == std::numbers::pi);
  CHECK(std::isfinite(drift[2].translation_m));
}

TEST_CASE("a place is a candidate if it is similar and within reach of plausible drift") {
  const Village village = street(1, -40.0, 200.0);
  PoseGraph graph = straight(30);
  std::vector<slam::ScanContext> contexts;
  for (const Pose& pose : graph.T_map_node) {
    contexts.push_back(
        slam::scan_context(village.scan(yard_pose(pose.translation().x(), 0.0, 0.0))));
  }
  // At the end the sensor is back at node 10, but estimated 25 m beside it.
  graph.T_map_node.push_back(pose_from_xyz_rpy({40.0, 25.0, 0.0}, 0.0, 0.0, 0.1));
  contexts.push_back(slam::scan_context(village.scan(yard_pose(40.5, 0.3, 0.0))));
  const auto candidates_with = [&](double drift_m, std::size_t old_nodes) {
    const std::vector<slam::PlausibleDrift> drift(31, {drift_m, 0.3});
    std::vector<std::size_t> nodes(old_nodes);
    std::iota(nodes.begin(), nodes.end(), std::size_t{0});
    return slam::loop_candidates(graph, contexts, {contexts.back()}, drift, nodes, 3);
  };
  const auto found = candidates_with(30.0, 20);
  REQUIRE(!found.empty());
  CHECK(found[0].node == 10);
  CHECK(std::abs(found[0].match.yaw_rad) < 0.11);
  for (std::size_t i = 1; i < found.size(); ++i) {
    CHECK(found[i].match.distance >= found[i - 1].match.distance);
    CHECK(std::abs(4.0 * static_cast<double>(found[i].node) - 40.0) >= 12.0);
  }
  CHECK(candidates_with(15.0, 20).empty());
  for (const auto& candidate : candidates_with(30.0, 8)) CHECK(candidate.node < 8);
}
