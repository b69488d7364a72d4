#include "loops/loop_candidates.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "alignment/motion_state.h"

namespace hqslam::slam {

namespace {

constexpr double kBaseDrift_m = 3.0;        // chosen in simulation alone
constexpr double kBaseDrift_rad = 0.09;     // 5 degrees
constexpr double kDrift_rad_per_m = 0.005;  // 0.3 degrees
constexpr double kLoopDrift_m = 0.2;
/// Distance from a node within which its place is recognized: another lane, between two nodes.
constexpr double kPassingDistance_m = 6.0;
constexpr double kSameCandidate_m = 12.0;
/// Distances of scans of one place were 0.04 to 0.3 (simulated drives).
constexpr double kMaxContextDistance = 0.35;

using Neighbour = std::pair<std::size_t, double>;  // node, drift along the edge

std::vector<std::vector<Neighbour>> neighbours_of(const PoseGraph& graph,
                                                  const std::vector<double>& edge_drift_m) {
  std::vector<std::vector<Neighbour>> result(graph.T_map_node.size());
  const auto connect = [&](std::size_t a, std::size_t b, double drift_m) {
    result[a].emplace_back(b, drift_m);
    result[b].emplace_back(a, drift_m);
  };
  for (std::size_t i = 0; i < edge_drift_m.size(); ++i) {
    connect(graph.odometry[i].from, graph.odometry[i].to, edge_drift_m[i]);
  }
  for (const PoseGraphEdge& loop : graph.loops) connect(loop.from, loop.to, kLoopDrift_m);
  return result;
}

double yaw_rad(const Pose& pose) { return roll_pitch_yaw_rad(pose).z(); }

}  // namespace

std::vector<PlausibleDrift> plausible_drift(const PoseGraph& graph,
                                            const std::vector<double>& edge_drift_m) {
  const auto neighbours = neighbours_of(graph, edge_drift_m);
  std::vector<double> drift_m(neighbours.size(), std::numeric_limits<double>::infinity());
  using Reached = std::pair<double, std::size_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> reached;
  if (!neighbours.empty()) {
    drift_m.back() = 0.0;
    reached.emplace(0.0, neighbours.size() - 1);
  }
  while (!reached.empty()) {
    const auto [so_far_m, node] = reached.top();
    reached.pop();
    if (so_far_m > drift_m[node]) continue;
    for (const auto& [next, step_m] : neighbours[node]) {
      if (so_far_m + step_m >= drift_m[next]) continue;
      drift_m[next] = so_far_m + step_m;
      reached.emplace(drift_m[next], next);
    }
  }
  std::vector<PlausibleDrift> result;
  result.reserve(drift_m.size());
  for (const double sum_m : drift_m) {
    result.push_back({kBaseDrift_m + sum_m,
                      std::min(kBaseDrift_rad + kDrift_rad_per_m * sum_m, std::numbers::pi)});
  }
  return result;
}

std::vector<LoopCandidate> loop_candidates(const PoseGraph& graph,
                                           const std::vector<ScanContext>& contexts,
                                           const std::vector<ScanContext>& last_contexts,
                                           const std::vector<PlausibleDrift>& drift,
                                           const std::vector<std::size_t>& nodes,
                                           std::size_t max_candidates) {
  const Pose& T_map_last = graph.T_map_node.back();
  std::vector<LoopCandidate> within_reach;
  for (const std::size_t node : nodes) {
    const Pose T_node_last = graph.T_map_node[node].inverse() * T_map_last;
    if (T_node_last.translation().norm() > drift[node].translation_m + kPassingDistance_m) continue;
    ScanContextMatch match;
    for (const ScanContext& last : last_contexts) {
      const ScanContextMatch from_lane =
          compare(contexts[node], last, yaw_rad(T_node_last), drift[node].rotation_rad);
      if (from_lane.distance < match.distance) match = from_lane;
    }
    if (match.distance <= kMaxContextDistance) within_reach.push_back({node, match});
  }
  std::ranges::stable_sort(within_reach, {},
                           [](const LoopCandidate& c) { return c.match.distance; });
  std::vector<LoopCandidate> result;
  for (const LoopCandidate& candidate : within_reach) {
    const auto near_candidate = [&](const LoopCandidate& chosen) {
      return distance_m(graph.T_map_node[chosen.node], graph.T_map_node[candidate.node]) <
             kSameCandidate_m;
    };
    if (std::ranges::any_of(result, near_candidate)) continue;
    result.push_back(candidate);
    if (result.size() == max_candidates) break;
  }
  return result;
}

}  // namespace hqslam::slam
