// The results of SLAM for the scans so far.

#include <limits>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/slam/saved_map.h"
#include "slam_implementation.h"
#include "thread_limit.h"

namespace hqslam::slam {

namespace {

/// Appends intensities to those of `points` points so far, which are NaN where they had none.
void append_known(std::vector<float>& intensity, const std::vector<float>& added,
                  std::size_t points) {
  if (intensity.empty() && added.empty()) return;
  intensity.resize(points, std::numeric_limits<float>::quiet_NaN());
  intensity.insert(intensity.end(), added.begin(), added.end());
}

}  // namespace

MountingOptions Slam::mounting() const { return implementation_->mounting.mounted(); }

const Trajectory& Slam::trajectory() const { return implementation_->path.trajectory(); }

const std::vector<std::size_t>& Slam::segment_of_scan() const {
  return implementation_->path.segment_of_scan();
}

std::vector<std::size_t> Slam::submap_of_scan() const {
  return implementation_->path.submap_of_scan();
}

std::vector<std::pair<std::size_t, Covariance>> Slam::corrected_covariances() const {
  return implementation_->path.corrected_covariances();
}

std::vector<Eigen::Vector3f> Slam::map_points_m(std::optional<std::size_t> submap,
                                                std::vector<float>* intensity) const {
  const ThreadLimit limit(implementation_->options.threads);
  const FeatureMaps& window = implementation_->mapping.map();
  const auto& loop_closing = implementation_->loop_closing;
  const std::vector<FeatureMaps> submaps =
      loop_closing ? loop_closing->whole_map(window) : std::vector<FeatureMaps>{window};
  std::vector<Eigen::Vector3f> result;
  if (intensity != nullptr) intensity->clear();
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    if (submap && *submap != i) continue;
    for (const FeatureMap* kind : {&submaps[i].planes, &submaps[i].edges}) {
      const std::vector<Eigen::Vector3f> points_m = kind->points_m();
      if (intensity != nullptr) append_known(*intensity, kind->intensity(), result.size());
      result.insert(result.end(), points_m.begin(), points_m.end());
    }
  }
  if (intensity != nullptr && !intensity->empty()) append_known(*intensity, {}, result.size());
  return result;
}

SavedMap Slam::saved_map() const {
  const ThreadLimit limit(implementation_->options.threads);
  const auto& loop_closing = implementation_->loop_closing;
  if (!loop_closing) {
    throw Error(
        "expected a drive that makes a map, found one located in a given map; save the map of a "
        "drive without one");
  }
  if (!implementation_->options.loop_closing.enabled) {
    throw Error(
        "expected loop closing, which collects the places of a map, found it switched off; switch "
        "it on");
  }
  const std::vector<FeatureMaps> submaps = loop_closing->whole_map(implementation_->mapping.map());
  SavedMap result;
  for (std::size_t submap = 0; submap < submaps.size(); ++submap) {
    std::vector<SavedPlace> places = loop_closing->finished().places(submap);
    if (places.size() <= result.places.size()) continue;
    const FeatureMaps& map = submaps[submap];
    result = {map.edges.points_m(),  map.posts.points_m(),  map.planes.points_m(),
              std::move(places),     map.edges.intensity(), map.posts.intensity(),
              map.planes.intensity()};
  }
  result.close_ratio = implementation_->map_fit.mean_close_ratio();
  return result;
}

}  // namespace hqslam::slam
