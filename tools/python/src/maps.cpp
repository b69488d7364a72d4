#include <nanobind/stl/optional.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/slam/dense_map.h"
#include "hqslam/slam/occupancy_grid.h"
#include "parts.h"
#include "paths.h"
#include "scans.h"

namespace hqslam::python {
namespace {

using slam::OccupancyMap;
using slam::SensorPath;

using Clouds = nb::typed<nb::sequence, std::optional<OrganizedCloud>>;
using Use = std::function<void(const OrganizedCloud&, const SensorPath&)>;
using NamedArrays = nb::typed<nb::dict, nb::str, nb::any>;

/// Hands each cloud that is not None to `use`, with its sensor's path, while other threads of
/// Python go on.
void for_each_scan(const Clouds& clouds, const Trajectory& trajectory, const Use& use) {
  if (nb::len(clouds) != trajectory.size()) {
    throw Error("clouds: expected one for each of the {} poses, or None, found {}",
                trajectory.size(), nb::len(clouds));
  }
  for (std::size_t scan = 0; scan < trajectory.size(); ++scan) {
    const nb::object given = clouds[scan];
    if (given.is_none()) continue;
    const auto& cloud = nb::cast<const OrganizedCloud&>(given);
    const OthersGoOn others_go_on;
    use(cloud, SensorPath(trajectory, scan));
  }
}

/// for_each_scan with the measured rows of each cloud alone.
void for_each_measured(const Clouds& clouds, const SensorModel& sensor,
                       const Trajectory& trajectory, const Use& use) {
  if (!sensor.measured_rows) return for_each_scan(clouds, trajectory, use);
  for_each_scan(clouds, trajectory, [&](const OrganizedCloud& cloud, const SensorPath& path) {
    use(select_rows(cloud, *sensor.measured_rows), path);
  });
}

NamedArrays dense_map(const Clouds& clouds, const SensorModel& sensor, const Trajectory& trajectory,
                      double voxel_m, double max_range_m, double least_confidence) {
  slam::DenseMap map(
      {.voxel_m = voxel_m, .max_range_m = max_range_m, .least_confidence = least_confidence});
  for_each_scan(clouds, trajectory, [&](const auto& cloud, const auto& path) {
    map.insert(cloud, sensor.measured_rows, path);
  });
  for_each_measured(clouds, sensor, trajectory,
                    [&](const auto& cloud, const auto& path) { map.see_through(cloud, path); });
  std::vector<float> intensity;
  std::vector<Eigen::Vector3f> points_m;
  std::vector<float> confidence;
  std::vector<std::uint32_t> times_seen;
  for (const slam::DenseMapPoint& point : map.points(&intensity)) {
    points_m.push_back(point.point_m);
    confidence.push_back(point.confidence);
    times_seen.push_back(point.times_seen);
  }
  NamedArrays arrays;
  const std::size_t count = points_m.size();
  arrays["points_m"] = owned_points(std::move(points_m));
  arrays["confidence"] = owned<Array<float, -1>>(std::move(confidence), {count});
  arrays["times_seen"] = owned<Array<std::uint32_t, -1>>(std::move(times_seen), {count});
  if (!intensity.empty()) {
    arrays["intensity"] = owned<Array<float, -1>>(std::move(intensity), {count});
  }
  return arrays;
}

OccupancyMap occupancy_grid(const Clouds& clouds, const SensorModel& sensor,
                            const Trajectory& trajectory, double resolution_m) {
  slam::OccupancyGrid grid({.resolution_m = resolution_m});
  const SensorModel measuring =
      sensor.measured_rows ? select_rows(sensor, *sensor.measured_rows) : sensor;
  for_each_measured(clouds, sensor, trajectory, [&](const auto& cloud, const auto& path) {
    grid.add_ground(cloud, measuring, path);
  });
  for_each_scan(clouds, trajectory, [&](const auto& cloud, const auto& path) {
    grid.insert(cloud, sensor.measured_rows, path);
  });
  for_each_measured(clouds, sensor, trajectory,
                    [&](const auto& cloud, const auto& path) { grid.see_through(cloud, path); });
  return grid.map();
}

void write_for_nav2(const OccupancyMap& map, const std::filesystem::path& yaml) {
  const std::filesystem::path image = std::filesystem::path(yaml).replace_extension(".pgm");
  write_occupancy_image(map, image.string());
  write_occupancy_yaml(map, image.filename().string(), yaml.string());
}

}  // namespace

void add_maps(nb::module_& module) {
  using namespace nb::literals;
  module.def("dense_map", &dense_map, "clouds"_a, "sensor"_a, "trajectory"_a, nb::kw_only(),
             "voxel_m"_a = 0.1, "max_range_m"_a = 50.0, "least_confidence"_a = 0.5,
             "A point for each voxel with a surface, without what moved: arrays points_m (N, 3), "
             "metres, map frame; confidence (N,), 0 to 1; times_seen (N,); intensity (N,) if the "
             "scans have any. clouds: LocatedScan.cloud of each pose of the trajectory, or None "
             "where the pose is not known. sensor: Pipeline.sensor. Raises Error.");
  nb::class_<OccupancyMap>(module, "OccupancyMap", "An occupancy grid.")
      .def_ro("resolution_m", &OccupancyMap::resolution_m, "Side of a cell, metres.")
      .def_prop_ro(
          "origin_m", [](const OccupancyMap& m) -> Eigen::Vector2d { return m.origin_m; },
          "(2,) float64: lower left corner, metres, map frame.")
      .def_prop_ro(
          "cells",
          [](const OccupancyMap& m) {
            return Array<const std::uint8_t, -1, -1>(
                m.cells.data(),
                {static_cast<std::size_t>(m.rows), static_cast<std::size_t>(m.columns)});
          },
          nb::rv_policy::reference_internal,
          "(rows, columns) uint8: 0 unknown, 1 free, 2 occupied; row 0 has the largest y.")
      .def("write", &write_for_nav2, "yaml"_a,
           "Writes this .yaml file and the .pgm image beside it, for Nav2. Raises Error.");
  module.def("occupancy_grid", &occupancy_grid, "clouds"_a, "sensor"_a, "trajectory"_a,
             nb::kw_only(), "resolution_m"_a = 0.1,
             "Where a robot can drive. clouds, sensor, trajectory: as of dense_map. Raises Error.");
}

}  // namespace hqslam::python
