#pragma once

#include <cstdint>
#include <vector>

#include "loops/pose_graph.h"

namespace hqslam::slam {

/// Whether poses bend no edge of the graph more than it can bear: an odometry edge by more than
/// twice its plausible drift, a loop by more than registrations of one place differ.
bool is_plausible(const PoseGraph& graph, const std::vector<double>& edge_drift_m,
                  const std::vector<Pose>& T_map_node);

/// Poses of all keyframes after the nodes among them moved.
///
/// In: poses of keyframes, which of them are nodes (rising, the first keyframe is one), the
/// nodes' new poses. Out: new poses. A keyframe between two nodes is carried along by either, and
/// lies between the two by its place in the path; those after the last node go with it. What would
/// move by less than a millimetre stays where it is, so that most of the map need not be touched.
std::vector<Pose> corrected_keyframes(const std::vector<Pose>& T_map_keyframe,
                                      const std::vector<std::uint32_t>& keyframe_of_node,
                                      const std::vector<Pose>& T_map_node);

}  // namespace hqslam::slam
