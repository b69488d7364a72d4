#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "loops/pose_graph.h"

namespace hqslam::slam {

/// Whether poses strain no edge of the graph too much: an odometry edge by more than twice its
/// plausible drift, a loop by more than registrations of one place differ.
bool is_plausible(const PoseGraph& graph, const std::vector<double>& edge_drift_m,
                  const std::vector<Pose>& T_map_node);

/// Poses of all keyframes after the nodes among them moved.
///
/// In: poses of keyframes, which of them are nodes (rising, the first keyframe is one), the nodes'
/// new poses. Out: new poses. A keyframe between two nodes is interpolated, by its position along
/// the path, between the poses that it would get from either; those after the last node move with
/// it. Motions of less than a millimetre are left out, so that most of the map is not touched.
std::vector<Pose> corrected_keyframes(std::span<const Pose> T_map_keyframe,
                                      const std::vector<std::uint32_t>& keyframe_of_node,
                                      std::span<const Pose> T_map_node);

}  // namespace hqslam::slam
