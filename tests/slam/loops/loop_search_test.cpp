#include "loops/loop_search.h"

#include "slam/village.h"

using slam::LoopStatus;

namespace {

/// A street driven through, node by node, and a scan taken at its end that may be anywhere in it.
struct DrivenStreet {
  SensorModel sensor = test::street_sensor();
  slam::Mapping mapping{slam::MappingOptions{}};
  slam::PoseGraph graph;
  std::vector<slam::ScanContext> contexts;
  std::vector<slam::ScanContext> last_contexts;
  slam::MapFeatures features;

  /// The scan of the last node is not in the map yet.
  void add_node(const OrganizedCloud& cloud, const Pose& T_map_sensor) {
    if (!contexts.empty()) mapping.insert(features, graph.T_map_node.back(), {});
    graph.T_map_node.push_back(T_map_sensor);
    last_contexts = slam::scan_contexts_from_lanes(cloud);
    contexts.push_back(last_contexts.front());
    features = test::features_of(cloud, sensor);
  }

  /// What is found for the last node if it could have drifted by `drift_m`.
  slam::LoopSearchResult search(double drift_m) const {
    std::vector<std::size_t> older(graph.T_map_node.size() - 1);
    std::iota(older.begin(), older.end(), std::size_t{0});
    const std::vector<slam::PlausibleDrift> drift(graph.T_map_node.size(), {drift_m, 0.3});
    const slam::MappingOptions options;
    return slam::search_loop(
        {options, mapping.map(), graph, contexts, last_contexts, drift, features, older});
  }
};

/// Nodes from x = -20 to 100 m of a street, then one, at x = 20 m by default, that is
/// estimated elsewhere.
DrivenStreet drive(const test::Village& village, const Pose& T_map_estimated,
                   const Pose& T_map_last = test::yard_pose(20.0, 1.0, 0.1)) {
  DrivenStreet street;
  for (double x_m = -20.0; x_m <= 100.0; x_m += 4.0) {
    const Pose pose = test::yard_pose(x_m, 0.0, 0.0);
    street.add_node(village.scan(pose), pose);
  }
  street.add_node(village.scan(T_map_last), T_map_estimated);
  return street;
}

}  // namespace

TEST_CASE("a place is found from far away, and the pose with it") {
  const Pose truth = test::yard_pose(20.0, 1.0, 0.1);
  const auto street = drive(test::street(31, -60.0, 200.0), test::yard_pose(35.0, 60.0, 0.2));
  const auto result = street.search(100.0);
  CHECK(result.status == LoopStatus::kAwaitsOthers);
  REQUIRE(result.loop);
  CHECK((result.loop->T_map_last.translation() - truth.translation()).norm() < 0.1);
  CHECK(rotation_angle_rad(truth.inverse() * result.loop->T_map_last) < 0.01);
  CHECK(std::abs(street.graph.T_map_node[result.loop->node].translation().x() - 20.0) <= 8.0);
  // Not if it would have had to drift farther than is plausible.
  CHECK(!street.search(50.0).loop);
}

TEST_CASE("a return in the other direction and lane is recognized by that lane's context alone") {
  const Pose truth = test::yard_pose(21.0, 3.8, std::numbers::pi);
  auto street = drive(test::street(31, -60.0, 200.0), test::yard_pose(35.0, 40.0, 3.0), truth);
  const auto result = street.search(100.0);
  REQUIRE(result.loop);
  CHECK((result.loop->T_map_last.translation() - truth.translation()).norm() < 0.1);
  CHECK(rotation_angle_rad(truth.inverse() * result.loop->T_map_last) < 0.01);
  street.last_contexts.resize(1);
  CHECK(street.search(100.0).candidates < result.candidates);
}

TEST_CASE("of two places that are alike none is taken") {
  const auto street = drive(test::street_of_two_equal_halves(), test::yard_pose(50.0, 60.0, 0.1));
  const auto result = street.search(100.0);
  CHECK(result.status == LoopStatus::kAmbiguous);
  CHECK(result.candidates >= 2);
  CHECK(!result.loop);
}

TEST_CASE("where the estimated pose fits no other place is searched") {
  const Pose near_truth = test::yard_pose(20.2, 0.9, 0.1);
  const auto result = drive(test::street_of_two_equal_halves(), near_truth).search(100.0);
  REQUIRE(result.loop);
  CHECK(result.candidates == 1);
  CHECK((result.loop->T_map_last.translation() - near_truth.translation()).norm() < 0.3);
}

TEST_CASE("a place that was never passed is not found") {
  DrivenStreet street = drive(test::street(31, -60.0, 200.0), test::yard_pose(20.0, 60.0, 0.0));
  const auto cloud = test::street(77, -60.0, 200.0).scan(test::yard_pose(20.0, 0.0, 0.0));
  street.graph.T_map_node.pop_back();
  street.contexts.pop_back();
  street.add_node(cloud, test::yard_pose(20.0, 60.0, 0.0));
  const auto result = street.search(100.0);
  CHECK(!result.loop);
  CHECK((result.status == LoopStatus::kNoCandidate || result.status == LoopStatus::kNotVerified));
}
