#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <string>
#include <tuple>

#include "arrays.h"
#include "hqslam/core/sensor_model.h"
#include "parts.h"
#include "paths.h"

namespace hqslam::python {
namespace {

/// All that a sensor is, for pickle; a stride of 0: all rows are measured.
using SensorState =
    std::tuple<std::string, int, double, double, double, std::vector<double>, std::vector<double>,
               std::vector<double>, std::vector<double>, int, int, bool>;
using Angles = Array<const double, -1>;

Angles view(const std::vector<double>& values) { return Angles(values.data(), {values.size()}); }

}  // namespace

void add_sensors(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<SensorModel>(module, "SensorModel",
                          "A spinning LiDAR as the geometry of its range image: row 0 is the "
                          "highest beam, column 0 looks backwards, columns go clockwise as seen "
                          "from above.")
      .def(
          "__init__",
          [](SensorModel* self, std::string name, int columns,
             const Input<double, -1>& beam_elevation_rad,
             const std::optional<Input<double, -1>>& beam_azimuth_offset_rad, double scan_period_s,
             double min_range_m, double max_range_m) {
            SensorModel sensor;
            sensor.name = std::move(name);
            sensor.columns = columns;
            sensor.scan_period_s = scan_period_s;
            sensor.min_range_m = min_range_m;
            sensor.max_range_m = max_range_m;
            sensor.beam_elevation_rad = values_of<double>(beam_elevation_rad);
            sensor.beam_azimuth_offset_rad = values_of<double>(beam_azimuth_offset_rad);
            if (!beam_azimuth_offset_rad) sensor.beam_azimuth_offset_rad.resize(sensor.rows());
            validate(sensor);
            new (self) SensorModel(std::move(sensor));
          },
          "name"_a, "columns"_a, "beam_elevation_rad"_a, "beam_azimuth_offset_rad"_a = nb::none(),
          "scan_period_s"_a = 0.1, "min_range_m"_a = 0.5, "max_range_m"_a = 120.0,
          "beam_elevation_rad: (rows,), falling; beam_azimuth_offset_rad: (rows,), "
          "counter-clockwise positive. Raises Error.")
      .def_ro("name", &SensorModel::name, "Its name.")
      .def_prop_ro("rows", &SensorModel::rows, "Beams.")
      .def_ro("columns", &SensorModel::columns, "Columns of a turn.")
      .def_ro("scan_period_s", &SensorModel::scan_period_s, "Seconds a turn takes.")
      .def_ro("min_range_m", &SensorModel::min_range_m, "What is nearer is no return, metres.")
      .def_ro("max_range_m", &SensorModel::max_range_m, "What is farther is no return, metres.")
      .def_prop_ro(
          "beam_elevation_rad", [](const SensorModel& s) { return view(s.beam_elevation_rad); },
          "(rows,) float64, radians, falling.")
      .def_prop_ro(
          "beam_azimuth_offset_rad",
          [](const SensorModel& s) { return view(s.beam_azimuth_offset_rad); },
          "(rows,) float64, radians, counter-clockwise positive.")
      .def_prop_ro(
          "measured_rows",
          [](const SensorModel& s) {
            return selected_rows(s.rows(), s.measured_rows.value_or(RowSelection{}));
          },
          "The rows that a beam measures; those between them are computed.")
      .def(
          "__eq__", [](const SensorModel& a, const SensorModel& b) { return a == b; },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const SensorModel& s) { return std::hash<std::string>{}(s.name); })
      .def("__getstate__",
           [](const SensorModel& s) {
             const RowSelection rows = s.measured_rows.value_or(RowSelection{0, 0});
             return SensorState(s.name, s.columns, s.scan_period_s, s.min_range_m, s.max_range_m,
                                s.beam_elevation_rad, s.beam_azimuth_offset_rad,
                                s.elevation_correction_rad, s.range_correction_m, rows.offset,
                                rows.stride, s.motion_corrected);
           })
      .def("__setstate__",
           [](SensorModel& sensor, const SensorState& state) {
             new (&sensor) SensorModel;
             RowSelection rows;
             std::tie(sensor.name, sensor.columns, sensor.scan_period_s, sensor.min_range_m,
                      sensor.max_range_m, sensor.beam_elevation_rad, sensor.beam_azimuth_offset_rad,
                      sensor.elevation_correction_rad, sensor.range_correction_m, rows.offset,
                      rows.stride, sensor.motion_corrected) = state;
             if (rows.stride > 0) sensor.measured_rows = rows;
           })
      .def("__repr__", [](const SensorModel& s) {
        return "SensorModel('" + s.name + "', " + std::to_string(s.rows()) + " x " +
               std::to_string(s.columns) + ")";
      });

  module.def("sensor_preset_names", &sensor_preset_names, "The names that load_sensor accepts.");
  module.def(
      "load_sensor",
      [](const std::filesystem::path& preset_or_path) {
        return load_sensor(preset_or_path.string());
      },
      "preset_or_path"_a, "A preset's name (os1-16, vlp-16, ...) or a .json file. Raises Error.");
  module.def(
      "select_rows",
      [](const SensorModel& sensor, int offset, int stride) {
        return select_rows(sensor, {offset, stride});
      },
      "sensor"_a, "offset"_a, "stride"_a,
      "The sensor that has only rows offset, offset + stride, ... Raises Error.");
  module.def(
      "write_sensor_json",
      [](const SensorModel& sensor, const std::filesystem::path& path) {
        write_sensor_json(sensor, path.string());
      },
      "sensor"_a, "path"_a, "Writes what load_sensor and every command read. Raises Error.");
}

}  // namespace hqslam::python
