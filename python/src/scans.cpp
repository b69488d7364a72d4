#include "scans.h"

#include <nanobind/stl/optional.h>

#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "parts.h"

namespace hqslam::python {
namespace {

std::optional<Image> optional_view(OrganizedCloud& cloud, std::vector<float>& values) {
  if (values.empty()) return std::nullopt;
  return view(values, cloud.rows, cloud.columns);
}

OrganizedCloud organized_cloud(const Input<float, -1, -1, 3>& points_m,
                               const std::optional<ImageInput>& time_offset_s) {
  OrganizedCloud cloud(static_cast<int>(points_m.shape(0)), static_cast<int>(points_m.shape(1)));
  cloud.points_m = values_of<Eigen::Vector3f>(points_m);
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    if (!cloud.points_m[i].allFinite()) cloud.points_m[i].setZero();
    cloud.range_m[i] = cloud.points_m[i].norm();
  }
  cloud.time_offset_s = values_of<float>(time_offset_s);
  if (!cloud.time_offset_s.empty() && cloud.time_offset_s.size() != cloud.range_m.size()) {
    throw Error("OrganizedCloud: {} times for {} x {} points, expected one per point or none",
                cloud.time_offset_s.size(), cloud.rows, cloud.columns);
  }
  return cloud;
}

}  // namespace

Pose pose_of(const Matrix4& matrix) {
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool is_rigid = matrix.allFinite() && matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
                        (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < 1e-3 &&
                        R.determinant() > 0.0;
  if (!is_rigid) throw Error("a 4 x 4 matrix that is no rotation and translation");
  return orthonormalized(Pose(Eigen::Matrix4d(matrix)));
}

RangeImage image_of(const ImageInput& range_m) {
  RangeImage image;
  image.rows = static_cast<int>(range_m.shape(0));
  image.columns = static_cast<int>(range_m.shape(1));
  image.range_m = values_of<float>(range_m);
  return image;
}

OrganizedCloud cloud_of(const PointsInput& points_m, const SensorModel& sensor,
                        const RowsInput& row, const TimesInput& time_offset_s) {
  Scan scan;
  scan.points_m = values_of<Eigen::Vector3f>(points_m);
  scan.row = values_of<std::uint16_t>(row);
  scan.time_offset_s = values_of<float>(time_offset_s);
  return project(scan, sensor).cloud;
}

void add_scans(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<OrganizedCloud>(
      module, "OrganizedCloud",
      "A scan: one point per pixel of a range image, sensor frame (x forward, y left, z up). Its "
      "arrays look at the scan's own memory: what is written to them is in the scan.")
      .def(
          "__init__",
          [](OrganizedCloud* self, const Input<float, -1, -1, 3>& points_m,
             const std::optional<ImageInput>& time_offset_s) {
            new (self) OrganizedCloud(organized_cloud(points_m, time_offset_s));
          },
          "points_m"_a, "time_offset_s"_a = nb::none(),
          "points_m: (rows, columns, 3), metres; zero or NaN is no return. time_offset_s: (rows, "
          "columns), seconds; none: the scan is corrected for motion. Raises Error.")
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
          "(rows, columns) float32, 0 to 1: 1 where measured; None: nothing is known of it.");

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
