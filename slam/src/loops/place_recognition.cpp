#include "loops/place_recognition.h"

#include <limits>
#include <numbers>
#include <numeric>

namespace hqslam::slam {

namespace {

constexpr PlausibleDrift kAnywhere{std::numeric_limits<double>::infinity(), std::numbers::pi};
constexpr PlausibleDrift kNearStart{10.0, 0.5};

}  // namespace

PlaceRecognition::PlaceRecognition(const MappingOptions& options,
                                   const std::vector<SavedPlace>& places,
                                   const std::optional<Pose>& T_map_sensor_start)
    : options_(options), places_(places.size()), has_start_(T_map_sensor_start.has_value()) {
  std::iota(places_.begin(), places_.end(), std::size_t{0});
  for (const SavedPlace& place : places) {
    graph_.T_map_node.push_back(place.T_map_sensor);
    contexts_.push_back(place.context);
  }
  graph_.T_map_node.push_back(T_map_sensor_start.value_or(Pose::Identity()));
}

std::optional<Pose> PlaceRecognition::find(const UnregisteredScan& scan, const FeatureMaps& map) {
  if (!scan.T_previous_sensor) recent_ = RecentFeatures(kRecentScans);
  const Pose motion = scan.T_previous_sensor.value_or(Pose::Identity());
  Pose& T_map_sensor = graph_.T_map_node.back();
  T_map_sensor = orthonormalized(T_map_sensor * motion);
  recent_.add(scan.features, T_map_sensor, {scan.velocity});
  const std::vector<ScanContext> last_contexts = scan_contexts_from_lanes(scan.cloud);
  const std::vector<PlausibleDrift> drift(graph_.T_map_node.size(),
                                          has_start_ ? kNearStart : kAnywhere);
  const auto search = [&](const MapFeatures& features) {
    const LoopSearchSpace space{options_,      map,   graph_,   contexts_,
                                last_contexts, drift, features, places_};
    return has_start_ ? search_loop(space).loop : search_similar_places(space).loop;
  };
  std::optional<FoundLoop> found = search(recent_.about_last());
  if (!found && scan.T_previous_sensor) found = search(scan.features);
  return found ? std::optional(found->T_map_last) : std::nullopt;
}

void PlaceRecognition::forget() {
  has_start_ = false;
  recent_ = RecentFeatures(kRecentScans);
}

}  // namespace hqslam::slam
