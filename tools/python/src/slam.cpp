#include "hqslam/slam/slam.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "hqslam/core/error.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/scan_trace.h"
#include "parts.h"
#include "paths.h"
#include "scans.h"
#include "slam_trace.h"

namespace hqslam::python {
namespace {

using slam::LoopReport;
using slam::SavedMap;
using slam::ScanReport;

/// Knows its sensor, for whoever gives it points.
struct Locating {
  slam::Slam slam;
  SensorModel sensor;
};
using Slam = Guarded<Locating>;
template <auto Method>
auto ask_slam(Slam& slam) {
  return slam.call([](Locating& locating) { return (locating.slam.*Method)(); });
}

using Options = std::map<std::string, double>;
slam::SlamOptions options_of(const Options& given, int threads, bool loop_closing) {
  slam::SlamOptions options;
  options.threads = threads;
  options.loop_closing.enabled = loop_closing;
  for (const auto& [name, value] : given) slam::set_option(options, name, value);
  validate(options);
  return options;
}

void make_slam(Slam* self, const SensorModel& sensor, const Options& given, const SavedMap* map,
               const std::optional<Matrix4>& T_map_level_start, int threads, bool loop_closing) {
  if (T_map_level_start && map == nullptr) {
    throw Error(
        "Slam: expected a map for T_map_level_start, found none; give map, or leave the start out");
  }
  const slam::SlamOptions options = options_of(given, threads, loop_closing);
  std::optional<Pose> start;
  if (T_map_level_start) start = pose_of(*T_map_level_start);
  const nb::gil_scoped_release others_go_on;
  if (map == nullptr) {
    new (self) Slam(Locating{slam::Slam(sensor, options), sensor});
  } else {
    new (self) Slam(Locating{slam::Slam(sensor, options, *map, start), sensor});
  }
}

ScanReport process(Slam& slam, const OrganizedCloud& cloud, double stamp_s,
                   const TraceInput& trace) {
  slam::ScanTrace written;
  const ScanReport report = slam.call([&](Locating& locating) {
    return locating.slam.process(cloud, stamp_s, trace ? &written : nullptr);
  });
  if (trace) show_slam_trace(std::move(written), *trace);
  return report;
}

ScanReport process_points(Slam& slam, const PointsInput& points_m, double stamp_s,
                          const RowsInput& row, const TimesInput& time_offset_s,
                          const TraceInput& trace) {
  const SensorModel sensor = slam.call([](Locating& locating) { return locating.sensor; });
  return process(slam, cloud_of(points_m, sensor, row, time_offset_s), stamp_s, trace);
}

void add_reports(nb::module_& module) {
  nb::class_<LoopReport>(module, "LoopReport", "What loop closing found out about a scan.")
      .def_prop_ro(
          "status", [](const LoopReport& l) { return std::string(name(l.status)); },
          "not searched, no candidate, not verified, ambiguous, awaits others, agrees, "
          "closed or implausible.")
      .def_ro("candidates", &LoopReport::candidates, "Places that were looked at.")
      .def_ro("scan", &LoopReport::scan, "The scan that was looked for.")
      .def_ro("older_scan", &LoopReport::older_scan, "The one that it met.")
      .def_ro("correction_m", &LoopReport::correction_m, "By how much its pose moved, metres.");

  nb::class_<ScanReport>(module, "ScanReport", "What happened to one scan.")
      .def_ro("stamp_s", &ScanReport::stamp_s, "Seconds.")
      .def_prop_ro(
          "T_map_sensor", [](const ScanReport& r) { return matrix_of(r.T_map_sensor); },
          "(4, 4) float64: takes points of the sensor's frame to the map's, metres.")
      .def_prop_ro(
          "T_odom_sensor", [](const ScanReport& r) { return matrix_of(r.T_odom_sensor); },
          "(4, 4) float64: of the odometry alone, which is smooth and drifts.")
      .def_prop_ro(
          "covariance", [](const ScanReport& r) -> Matrix6 { return r.covariance; },
          "(6, 6) float64: of e in T_true = T_map_sensor exp(e), (linear, angular) in the sensor's "
          "frame, m^2, m rad, rad^2; infinite where the place is not known.")
      .def_prop_ro(
          "odometry_status",
          [](const ScanReport& r) { return std::string(name(r.odometry_status)); },
          "ok, too few features, degenerate or not converged.")
      .def_prop_ro(
          "mapping_status", [](const ScanReport& r) { return std::string(name(r.mapping_status)); },
          "As odometry_status, or after a gap, or not recognized.")
      .def_prop_ro(
          "is_registered", [](const ScanReport& r) { return is_registered(r.mapping_status); },
          "Whether the pose was measured against the map.")
      .def_ro("returns", &ScanReport::returns, "Pixels with a return.")
      .def_ro("edge_correspondences", &ScanReport::edge_correspondences, "Edges matched.")
      .def_ro("planar_correspondences", &ScanReport::planar_correspondences,
              "Planar points matched.")
      .def_ro("keyframe", &ScanReport::keyframe, "Whether it became part of the map.")
      .def_ro("loop", &ScanReport::loop, "What loop closing found out.")
      .def_prop_ro(
          "time_s", [](const ScanReport& r) { return r.times.total_s; },
          "Seconds that the scan took.");
}

void add_saved_map(nb::module_& module) {
  using namespace nb::literals;
  const auto points = [](std::vector<Eigen::Vector3f>& points_m) {
    return PointList(reinterpret_cast<float*>(points_m.data()), {points_m.size(), 3});
  };
  nb::class_<SavedMap>(module, "SavedMap", "What a drive leaves behind to be located in later.")
      .def_prop_ro(
          "edges_m", [=](SavedMap& m) { return points(m.edges_m); },
          "(N, 3) float32, metres, map frame.")
      .def_prop_ro(
          "posts_m", [=](SavedMap& m) { return points(m.posts_m); },
          "(N, 3) float32, metres, map frame.")
      .def_prop_ro(
          "planes_m", [=](SavedMap& m) { return points(m.planes_m); },
          "(N, 3) float32, metres, map frame.")
      .def(
          "write",
          [](const SavedMap& map, const std::filesystem::path& path) {
            write_saved_map(path.string(), map);
          },
          "path"_a, "Writes an .npz file, which numpy reads, too. Raises Error.");
  module.def(
      "read_saved_map",
      [](const std::filesystem::path& path) { return slam::read_saved_map(path.string()); },
      "path"_a, "Reads what SavedMap.write or `hqslam run --save-map` wrote. Raises Error.");
}

}  // namespace

void add_slam(nb::module_& module) {
  using namespace nb::literals;
  add_reports(module);
  add_saved_map(module);
  nb::class_<Slam>(module, "Slam", "Scan in, pose out. The map's frame is the first scan's, level.")
      .def(
          "__init__", &make_slam, "sensor"_a, "options"_a = Options(), "map"_a = nb::none(),
          "T_map_level_start"_a = nb::none(), nb::kw_only(), "threads"_a = 0,
          "loop_closing"_a = true,
          "options: values by the names that `hqslam slam-options` lists. map: to be located in, "
          "which stays as it "
          "is; T_map_level_start, (4, 4): where the drive begins in it, if that is known. threads: "
          "0, all. Raises Error.")
      .def("process", &process, "cloud"_a, "stamp_s"_a, "trace"_a = nb::none(),
           "Locates a scan. stamp_s: the time of its middle, seconds. trace: a dict that is filled "
           "with what each stage made of it: arrays by name. Raises Error, ScanError.")
      .def("process", &process_points, "points_m"_a, "stamp_s"_a, "row"_a = nb::none(),
           "time_offset_s"_a = nb::none(), "trace"_a = nb::none(),
           "The same for points as project takes them.")
      .def(
          "add_imu",
          [](Slam& slam, const Input<double, -1, 7>& samples) {
            slam.call([&](Locating& l) { l.slam.add_imu(values_of<ImuSample>(samples)); });
          },
          "samples"_a,
          "What an inertial sensor measured up to the end of the next scan: RecordedScan.imu.")
      .def("finish", &ask_slam<&slam::Slam::finish>,
           "After the last scan: takes in what loop closing was still finding out.")
      .def("trajectory", &ask_slam<&slam::Slam::trajectory>,
           "Of every scan so far, with its loops closed.")
      .def(
          "map_points_m",
          [](Slam& slam) {
            return owned_points(slam.call([](auto& inner) { return inner.slam.map_points_m(); }));
          },
          "(N, 3) float32, metres, map frame.")
      .def(
          "map_intensity",
          [](Slam& slam) {
            std::vector<float> intensity;
            slam.call([&](auto& inner) { return inner.slam.map_points_m({}, &intensity); });
            const std::size_t count = intensity.size();
            return owned<Array<float, -1>>(std::move(intensity), {count});
          },
          "(N,) float32 of map_points_m(), the mean of what the scans had there, in their unit, "
          "not "
          "a number where that is not known; of no points where no scan had any.")
      .def("submap_of_scan", &ask_slam<&slam::Slam::submap_of_scan>,
           "Per scan the submap it is in; nothing is known of how submaps lie to each other.")
      .def("saved_map", &ask_slam<&slam::Slam::saved_map>,
           "What later drives are located in. Raises Error without loop closing.");
}

}  // namespace hqslam::python
