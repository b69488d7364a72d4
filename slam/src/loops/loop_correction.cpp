#include "loops/loop_correction.h"

#include <algorithm>

#include "alignment/motion_state.h"

namespace hqslam::slam {

namespace {

// Largest strain of a right loop.
constexpr double kMaxLoopStrain_m = 0.5;
constexpr double kMaxLoopStrain_rad = 0.02;

constexpr double kMaxOdometryStrain_m = 0.05;
constexpr double kMaxOdometryStrain_rad = 0.02;
constexpr double kStrainPerDrift = 2.0;

// Smaller motions of a keyframe are left out, and remain as steps to its neighbours: with
// 1 cm simulated drives are less accurate over ten metres.
constexpr double kLeastMove_m = 0.001;
constexpr double kLeastTurn_rad = 0.00003;  // 1.5 mm in 50 m

}  // namespace

bool is_plausible(const PoseGraph& graph, const std::vector<double>& edge_drift_m,
                  const std::vector<Pose>& T_map_node) {
  for (std::size_t i = 0; i < graph.odometry.size(); ++i) {
    const double max_m = kMaxOdometryStrain_m + kStrainPerDrift * edge_drift_m[i];
    const Pose strain = disagreement(graph.odometry[i], T_map_node);
    if (!is_within(strain, max_m, kMaxOdometryStrain_rad)) return false;
  }
  return std::ranges::all_of(graph.loops, [&](const PoseGraphEdge& loop) {
    return is_within(disagreement(loop, T_map_node), kMaxLoopStrain_m, kMaxLoopStrain_rad);
  });
}

std::vector<Pose> corrected_keyframes(std::span<const Pose> T_map_keyframe,
                                      const std::vector<std::uint32_t>& keyframe_of_node,
                                      std::span<const Pose> T_map_node) {
  std::vector<double> path_m(T_map_keyframe.size(), 0.0);
  for (std::size_t k = 1; k < path_m.size(); ++k) {
    path_m[k] = path_m[k - 1] + distance_m(T_map_keyframe[k], T_map_keyframe[k - 1]);
  }
  std::vector<Pose> result(T_map_keyframe.begin(), T_map_keyframe.end());
  std::size_t node = 0;
  for (std::size_t k = 0; k < result.size(); ++k) {
    while (node + 1 < keyframe_of_node.size() && keyframe_of_node[node + 1] <= k) ++node;
    const auto carried_by = [&](std::size_t i) {
      const Pose T_node_keyframe =
          T_map_keyframe[keyframe_of_node[i]].inverse() * T_map_keyframe[k];
      return Pose(T_map_node[i] * T_node_keyframe);
    };
    Pose corrected = carried_by(node);
    if (node + 1 < keyframe_of_node.size()) {
      const double begin_m = path_m[keyframe_of_node[node]];
      const double length_m = path_m[keyframe_of_node[node + 1]] - begin_m;
      const double fraction = length_m > 0.0 ? (path_m[k] - begin_m) / length_m : 0.0;
      corrected = interpolate(corrected, carried_by(node + 1), fraction);
    }
    const Pose move = result[k].inverse() * corrected;
    if (move.translation().norm() >= kLeastMove_m || rotation_angle_rad(move) >= kLeastTurn_rad) {
      result[k] = orthonormalized(corrected);
    }
  }
  return result;
}

}  // namespace hqslam::slam
