#include "evaluate/map_error.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "hqslam/core/error.h"
#include "hqslam/evaluation/cloud_error.h"

namespace hqslam::tools {
namespace {

constexpr double kSample_m = 0.1;
constexpr double kFar_m = 0.3;

/// The voxel of kSample_m that a point is in, as one number. Cities are smaller than 100 km.
std::uint64_t voxel_key(const Eigen::Vector3f& point_m) {
  const auto part = [](float metres) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(metres / kSample_m))) &
           0x1FFFFFU;
  };
  return part(point_m.x()) << 42U | part(point_m.y()) << 21U | part(point_m.z());
}

double share_within(const std::vector<float>& distances_m, double limit_m) {
  const auto within = std::count_if(distances_m.begin(), distances_m.end(),
                                    [&](float distance_m) { return distance_m <= limit_m; });
  return static_cast<double>(within) / static_cast<double>(distances_m.size());
}

SharesWithin shares_within(const std::vector<float>& distances_m) {
  return {share_within(distances_m, 0.1), share_within(distances_m, 0.2)};
}

double harmonic_mean(double a, double b) { return a + b > 0.0 ? 2.0 * a * b / (a + b) : 0.0; }

}  // namespace

std::vector<Eigen::Vector3f> visible_surface_m(sim::DriveSimulator simulator) {
  std::vector<Eigen::Vector3f> samples_m;
  std::unordered_set<std::uint64_t> taken;
  while (const auto visible = simulator.next_visible()) {
    for (const Eigen::Vector3f& point_m : *visible) {
      if (taken.insert(voxel_key(point_m)).second) samples_m.push_back(point_m);
    }
  }
  return samples_m;
}

MapError map_error(const std::vector<Eigen::Vector3f>& points_m,
                   const std::vector<Eigen::Vector3f>& visible_m, sim::DriveSimulator& truth) {
  if (points_m.empty() || visible_m.empty()) {
    throw Error("the map or the visible surface has no points; give a map of the drive");
  }
  const std::vector<float> to_surface_m = truth.distances_to_surface_m(points_m, kFar_m);
  const std::vector<float> to_map_m = nearest_distances_m(visible_m, points_m);
  MapError error;
  error.points = std::ssize(points_m);
  error.accuracy = shares_within(to_surface_m);
  error.beyond_30_cm = 1.0 - share_within(to_surface_m, kFar_m);
  error.completeness = shares_within(to_map_m);
  error.f1 = {harmonic_mean(error.accuracy.at_10_cm, error.completeness.at_10_cm),
              harmonic_mean(error.accuracy.at_20_cm, error.completeness.at_20_cm)};
  return error;
}

}  // namespace hqslam::tools
