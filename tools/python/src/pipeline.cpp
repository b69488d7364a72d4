#include "hqslam/pipeline/pipeline.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "hqslam/core/error.h"
#include "parts.h"
#include "paths.h"
#include "scans.h"
#include "slam_trace.h"

namespace hqslam::python {
namespace {

using pipeline::LocatedScan;
using Pipeline = Guarded<pipeline::Pipeline>;
using Options = std::map<std::string, double>;

pipeline::SlamKind slam_kind(const std::string& slam) {
  if (slam == "hqslam") return pipeline::SlamKind::kHqslam;
  if (slam == "lego-loam") return pipeline::SlamKind::kLegoLoam;
  throw Error("slam='{}': expected 'hqslam' or 'lego-loam'; give one of them", slam);
}

void make_pipeline(Pipeline* self, const SensorModel& sensor, const std::filesystem::path& upsample,
                   const std::string& slam, const Options& given, const slam::SavedMap* map,
                   const std::optional<Matrix4>& T_map_level_start, int rows, double spacing_rad,
                   std::optional<float> least_confidence, int threads, bool loop_closing) {
  if (T_map_level_start && map == nullptr) {
    throw Error(
        "Pipeline: expected a map for T_map_level_start, found none; give map, or leave the start "
        "out");
  }
  pipeline::PipelineOptions options;
  options.upsampling.method = upsample.string();
  options.upsampling.rows = rows;
  options.upsampling.spacing_rad = spacing_rad;
  options.upsampling.network.threads = threads;
  options.upsampling.network.least_confidence = least_confidence;
  options.slam = slam_kind(slam);
  options.slam_options.threads = threads;
  options.slam_options.loop_closing.enabled = loop_closing;
  for (const auto& [name, value] : given) slam::set_option(options.slam_options, name, value);
  validate(options.slam_options);
  if (map != nullptr) options.map = *map;
  if (T_map_level_start) options.T_map_level_start = pose_of(*T_map_level_start);
  const OthersGoOn others_go_on;
  new (self) Pipeline(pipeline::Pipeline(sensor, options));
}

template <typename... Given>
LocatedScan process(Pipeline& pipeline, const TraceInput& trace, const Given&... given) {
  slam::ScanTrace written;
  LocatedScan located = pipeline.call([&](pipeline::Pipeline& inner) {
    return inner.process(given..., trace ? &written : nullptr);
  });
  if (trace) show_slam_trace(std::move(written), *trace);
  return located;
}

LocatedScan process_recorded(Pipeline& pipeline, const RecordedScan& scan,
                             const TraceInput& trace) {
  return process(pipeline, trace, scan);
}

LocatedScan process_cloud(Pipeline& pipeline, const OrganizedCloud& cloud, double stamp_s,
                          const TraceInput& trace) {
  return process(pipeline, trace, cloud, stamp_s);
}

LocatedScan process_points(Pipeline& pipeline, const PointsInput& points_m, double stamp_s,
                           const RowsInput& row, const TimesInput& time_offset_s,
                           const TraceInput& trace) {
  Scan points = scan_of(points_m, row, time_offset_s);
  points.stamp_s = stamp_s;
  return process(pipeline, trace, points);
}

template <auto Method>
auto ask_pipeline(Pipeline& pipeline) {
  return pipeline.call([](pipeline::Pipeline& inner) { return (inner.*Method)(); });
}

}  // namespace

void add_pipeline(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<LocatedScan>(module, "LocatedScan", "One scan after upsampling and SLAM.")
      .def_ro("cloud", &LocatedScan::cloud, "What SLAM took in: the measured rows, or all rows.")
      .def_ro("report", &LocatedScan::report, "What SLAM made of it.")
      .def_ro("upsampling_s", &LocatedScan::upsampling_s, "Seconds that the upsampling took.");
  nb::class_<Pipeline>(module, "Pipeline",
                       "Recorded scans in, poses and a map out: upsampling with its memory, and "
                       "SLAM. The map's frame is that of the first scan, turned level.")
      .def(
          "__init__", &make_pipeline, "sensor"_a, "upsample"_a = "", nb::kw_only(),
          "slam"_a = "hqslam", "options"_a = Options(), "map"_a = nb::none(),
          "T_map_level_start"_a = nb::none(), "rows"_a = 0, "spacing_rad"_a = 0.0,
          "least_confidence"_a = nb::none(), "threads"_a = 0, "loop_closing"_a = true,
          "sensor: of the scans. upsample: a weights file, the name of weights that come with "
          "hqslam (du-mix) or an interpolation; '': none. slam: hqslam or lego-loam. options: "
          "values by the names that `hqslam slam-options` lists. map: scans are located in it, and "
          "it stays as it is; T_map_level_start, (4, 4): the first pose in it. rows: how many rows "
          "are used as measured, 0: all, or the network's. spacing_rad: widest gap between two "
          "rows of the result, with weights for any sensor; 0: 64 rows. least_confidence: computed "
          "pixels with less come out empty, 0 to 1. threads: 0, all. Raises Error.")
      .def("process", &process_recorded, "scan"_a, "trace"_a = nb::none(),
           "Locates a scan of a recording, with its inertial samples. trace: a dict that is filled "
           "with what each stage of SLAM made of it: arrays by name. Raises Error, ScanError.")
      .def("process", &process_cloud, "cloud"_a, "stamp_s"_a, "trace"_a = nb::none(),
           "Locates a scan. stamp_s: the time of its middle, seconds.")
      .def("process", &process_points, "points_m"_a, "stamp_s"_a, "row"_a = nb::none(),
           "time_offset_s"_a = nb::none(), "trace"_a = nb::none(),
           "Locates points as project takes them.")
      .def(
          "add_imu",
          [](Pipeline& pipeline, const Input<double, -1, 7>& samples) {
            pipeline.call([&](pipeline::Pipeline& p) { p.add_imu(values_of<ImuSample>(samples)); });
          },
          "samples"_a,
          "What an inertial sensor measured up to the end of the next scan, as RecordedScan.imu; "
          "process takes those of a RecordedScan itself.")
      .def("finish", &ask_pipeline<&pipeline::Pipeline::finish>,
           "After the last scan: takes in what loop closing was still finding out.")
      .def_prop_ro("sensor", &ask_pipeline<&pipeline::Pipeline::sensor>,
                   "The sensor of LocatedScan.cloud.")
      .def("trajectory", &ask_pipeline<&pipeline::Pipeline::trajectory>,
           "The poses of all scans so far, with the loops that were closed.")
      .def(
          "map_points_m",
          [](Pipeline& pipeline) {
            return owned_points(
                pipeline.call([](pipeline::Pipeline& p) { return p.map_points_m(); }));
          },
          "(N, 3) float32, metres, map frame.")
      .def(
          "map_intensity",
          [](Pipeline& pipeline) {
            std::vector<float> intensity;
            pipeline.call([&](pipeline::Pipeline& p) { p.map_points_m({}, &intensity); });
            const std::size_t count = intensity.size();
            return owned<Array<float, -1>>(std::move(intensity), {count});
          },
          "(N,) float32 of map_points_m(), the mean of the scans' intensities there, in their "
          "unit, nan where unknown; empty where the scans have none.")
      .def("submap_of_scan", &ask_pipeline<&pipeline::Pipeline::submap_of_scan>,
           "Per scan the submap it is in; relative poses between submaps are unknown.")
      .def("saved_map", &ask_pipeline<&pipeline::Pipeline::saved_map>,
           "What later drives are located in. Raises Error without loop closing.");
}

}  // namespace hqslam::python
