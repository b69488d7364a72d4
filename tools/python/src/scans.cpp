#include "scans.h"

#include <nanobind/stl/optional.h>

#include "hqslam/core/projection.h"
#include "parts.h"

namespace hqslam::python {
namespace {

std::optional<Image> optional_view(OrganizedCloud& cloud, std::vector<float>& values) {
  if (values.empty()) return std::nullopt;
  return view(values, cloud.rows, cloud.columns);
}

}  // namespace

RangeImage image_of(const ImageInput& range_m) {
  RangeImage image;
  image.rows = static_cast<int>(range_m.shape(0));
  image.columns = static_cast<int>(range_m.shape(1));
  image.range_m = values_of<float>(range_m);
  return image;
}

Scan scan_of(const PointsInput& points_m, const RowsInput& row, const TimesInput& time_offset_s) {
  Scan scan;
  scan.points_m = values_of<Eigen::Vector3f>(points_m);
  scan.row = values_of<std::uint16_t>(row);
  scan.time_offset_s = values_of<float>(time_offset_s);
  return scan;
}

OrganizedCloud cloud_of(const PointsInput& points_m, const SensorModel& sensor,
                        const RowsInput& row, const TimesInput& time_offset_s) {
  return project(scan_of(points_m, row, time_offset_s), sensor).cloud;
}

void add_scans(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<OrganizedCloud>(
      module, "OrganizedCloud",
      "A scan: one point per pixel of a range image, sensor frame (x forward, y left, z up). Its "
      "arrays look at the scan's own memory: what is written to them is in the scan.")
      .def_ro("rows", &OrganizedCloud::rows, "Beams; row 0 is the highest.")
      .def_ro("columns", &OrganizedCloud::columns, "Columns; column 0 looks backwards.")
      .def_prop_ro(
          "points_m",
          [](OrganizedCloud& c) {
            return PointGrid(
                reinterpret_cast<float*>(c.points_m.data()),
                {static_cast<std::size_t>(c.rows), static_cast<std::size_t>(c.columns), 3});
          },
          "(rows, columns, 3) float32, metres; zero where nothing returned.")
      .def_prop_ro(
          "range_m", [](OrganizedCloud& c) { return view(c.range_m, c.rows, c.columns); },
          "(rows, columns) float32, metres; 0 where nothing returned.")
      .def_prop_ro(
          "time_offset_s", [](OrganizedCloud& c) { return optional_view(c, c.time_offset_s); },
          "(rows, columns) float32, seconds after the scan's stamp; None: corrected for motion.")
      .def_prop_ro(
          "confidence", [](OrganizedCloud& c) { return optional_view(c, c.confidence); },
          "(rows, columns) float32, 0 to 1: 1 where measured; None: nothing is known of it.")
      .def_prop_ro(
          "intensity", [](OrganizedCloud& c) { return optional_view(c, c.intensity); },
          "(rows, columns) float32, in the recording's unit, of computed points between the "
          "measured "
          "ones; nan where it is not known. None: the recording has none.");

  module.def(
      "project",
      [](const PointsInput& points_m, const SensorModel& sensor, const RowsInput& row,
         const TimesInput& time_offset_s) {
        return cloud_of(points_m, sensor, row, time_offset_s);
      },
      "points_m"_a, "sensor"_a, "row"_a = nb::none(), "time_offset_s"_a = nb::none(),
      "Puts points into the sensor's pixels. points_m: (N, 3), metres, sensor frame. row: (N,), 0 "
      "the highest beam (of rings that count from below: sensor.rows - 1 - ring); none: the beam "
      "nearest in elevation. time_offset_s: (N,), seconds after the scan's stamp, which is the "
      "middle of the turn; none: corrected for motion. Raises Error.");
  module.def("calibrated", &calibrated, "cloud"_a, "sensor"_a,
             "The scan with the corrections of each beam that hqslam calibrate wrote into the "
             "sensor's file; as it is where there are none. Raises Error.");
  module.def(
      "unproject",
      [](const ImageInput& range_m, const SensorModel& sensor, bool motion_corrected) {
        return unproject(image_of(range_m), sensor,
                         motion_corrected ? CaptureTime::kMotionCorrected : CaptureTime::kRolling);
      },
      "range_m"_a, "sensor"_a, "motion_corrected"_a = false,
      "Makes points of a range image, (rows, columns), metres; 0 is no return. Raises Error.");
}

}  // namespace hqslam::python
