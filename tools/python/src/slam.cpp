#include "hqslam/slam/slam.h"

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "hqslam/slam/saved_map.h"
#include "parts.h"
#include "paths.h"
#include "scans.h"

namespace hqslam::python {
namespace {

using slam::LoopReport;
using slam::SavedMap;
using slam::ScanReport;

void add_reports(nb::module_& module) {
  nb::class_<LoopReport>(module, "LoopReport", "What loop closing found out about a scan.")
      .def_prop_ro(
          "status", [](const LoopReport& l) { return std::string(name(l.status)); },
          "not searched, no candidate, not verified, ambiguous, awaits others, agrees, "
          "closed or implausible.")
      .def_ro("candidates", &LoopReport::candidates, "Places that were compared.")
      .def_ro("scan", &LoopReport::scan, "The scan that was looked for.")
      .def_ro("older_scan", &LoopReport::older_scan, "The one that it met.")
      .def_ro("correction_m", &LoopReport::correction_m, "By how much its pose moved, metres.");

  nb::class_<ScanReport>(module, "ScanReport", "What happened to one scan.")
      .def("__repr__",
           [](const ScanReport& r) {
             const Eigen::Vector3d at_m = r.T_map_sensor.translation();
             return fmt::format("ScanReport({:.3f} s, [{:.2f} {:.2f} {:.2f}] m, mapping {})",
                                r.stamp_s, at_m.x(), at_m.y(), at_m.z(), name(r.mapping_status));
           })
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
          "As odometry_status, or after a gap, map in doubt or not recognized.")
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
  add_reports(module);
  add_saved_map(module);
}

}  // namespace hqslam::python
