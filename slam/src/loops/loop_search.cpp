#include "loops/loop_search.h"

#include <algorithm>
#include <utility>

#include "loops/place_search.h"

namespace hqslam::slam {

namespace {

constexpr std::size_t kMaxCandidates = 3;
constexpr double kNearNode_m = 10.0;
constexpr double kOtherPlace_m = 2.0;
/// Smallest ratio of a placement's share of points to the best one's. Chosen in simulation alone.
constexpr double kWorthVerifying = 0.9;
/// Ratio of the overlaps of the second-best and the best place from which on they are ambiguous.
/// Chosen in simulation alone.
constexpr double kAmbiguousShare = 0.8;

Mapping map_about(const LoopSearchSpace& space, const Pose& T_map_place) {
  const Surroundings place = loop_surroundings(T_map_place);
  FeatureMaps local = space.map.about(space.options, place);
  if (space.taken != nullptr) local.insert(space.taken->about(space.options, place).take_all());
  return {space.options, std::move(local)};
}

std::optional<FoundLoop> verified(const LoopSearchSpace& space, std::size_t node,
                                  const Mapping& local, const Pose& T_map_last_start) {
  const std::optional<VerifiedLoop> loop = verify_loop(space.features, local, T_map_last_start);
  if (!loop) return std::nullopt;
  const Pose change = space.graph.T_map_node.back().inverse() * loop->T_map_sensor;
  const PlausibleDrift& drift = space.drift[node];
  if (!is_within(change, drift.translation_m, drift.rotation_rad)) return std::nullopt;
  return FoundLoop{node, loop->T_map_sensor, loop->fit.overlap};
}

std::vector<Eigen::Vector3f> in_frame(const std::vector<Eigen::Vector3f>& points_m,
                                      const Pose& T_map_frame) {
  const Eigen::Isometry3f T_frame_map = T_map_frame.inverse().cast<float>();
  std::vector<Eigen::Vector3f> result;
  result.reserve(points_m.size());
  for (const Eigen::Vector3f& point_m : points_m) result.push_back(T_frame_map * point_m);
  return result;
}

/// Edges and walls of a local map, in the frame of a place.
std::vector<Eigen::Vector3f> structure_of(const Mapping& local, const Pose& T_map_place) {
  std::vector<Eigen::Vector3f> points_m = local.map().planes.points_m();
  const std::vector<Eigen::Vector3f> edges_m = local.map().edges.points_m();
  points_m.insert(points_m.end(), edges_m.begin(), edges_m.end());
  return upright_structure_m(in_frame(points_m, T_map_place));
}

std::vector<Eigen::Vector3f> upright_features(const MapFeatures& features) {
  std::vector<Eigen::Vector3f> result;
  // Every other one: enough to find the place.
  for (const auto* kind : {&features.edges, &features.surfaces_to_register}) {
    for (std::size_t i = 0; i < kind->size(); i += 2) result.push_back((*kind)[i].point_m);
  }
  return result;
}

std::vector<FoundLoop> loops_at_candidate(const LoopSearchSpace& space,
                                          const LoopCandidate& candidate) {
  const Pose& T_map_place = space.graph.T_map_node[candidate.node];
  const Mapping local = map_about(space, T_map_place);
  std::vector<FoundLoop> result;
  const std::vector<PlacedPoints> places = search_place(
      structure_of(local, T_map_place), upright_features(space.features), candidate.match.yaw_rad);
  for (const PlacedPoints& placed : places) {
    if (placed.share < kWorthVerifying * places.front().share) break;
    const auto loop = verified(space, candidate.node, local, T_map_place * placed.T_place_sensor);
    if (loop) result.push_back(*loop);
  }
  return result;
}

bool is_elsewhere(const FoundLoop& a, const FoundLoop& b) {
  return distance_m(a.T_map_last, b.T_map_last) >= kOtherPlace_m;
}

}  // namespace

Surroundings loop_surroundings(const Pose& T_map_place) {
  constexpr float kRadius_m = 45.0F;
  return {T_map_place.translation().cast<float>(), kRadius_m};
}

std::optional<FoundLoop> loop_at(const LoopSearchSpace& space, const Pose& T_map_last_estimated) {
  std::optional<std::size_t> nearest;
  double nearest_m = kNearNode_m;
  for (const std::size_t node : space.nodes) {
    const double away_m = distance_m(space.graph.T_map_node[node], T_map_last_estimated);
    if (away_m >= nearest_m) continue;
    nearest = node;
    nearest_m = away_m;
  }
  if (!nearest) return std::nullopt;
  return verified(space, *nearest, map_about(space, T_map_last_estimated), T_map_last_estimated);
}

LoopSearchResult search_loop(const LoopSearchSpace& space) {
  if (const auto loop = loop_at(space, space.graph.T_map_node.back())) {
    return {LoopStatus::kAwaitsOthers, 1, loop};
  }
  return search_similar_places(space);
}

LoopSearchResult search_similar_places(const LoopSearchSpace& space) {
  LoopSearchResult result;
  const std::vector<LoopCandidate> candidates = loop_candidates(
      space.graph, space.contexts, space.last_contexts, space.drift, space.nodes, kMaxCandidates);
  result.candidates = static_cast<int>(candidates.size());
  if (candidates.empty()) return result;
  std::vector<FoundLoop> loops;
  for (const LoopCandidate& candidate : candidates) {
    const std::vector<FoundLoop> found = loops_at_candidate(space, candidate);
    loops.insert(loops.end(), found.begin(), found.end());
  }
  result.status = LoopStatus::kNotVerified;
  if (loops.empty()) return result;
  const auto fits_worse = [](const FoundLoop& a, const FoundLoop& b) {
    return a.overlap < b.overlap;
  };
  const FoundLoop best = *std::ranges::max_element(loops, fits_worse);
  const bool ambiguous = std::ranges::any_of(loops, [&](const FoundLoop& other) {
    return is_elsewhere(other, best) && other.overlap >= kAmbiguousShare * best.overlap;
  });
  result.status = ambiguous ? LoopStatus::kAmbiguous : LoopStatus::kAwaitsOthers;
  if (!ambiguous) result.loop = best;
  return result;
}

}  // namespace hqslam::slam
