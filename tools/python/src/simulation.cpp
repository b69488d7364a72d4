#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "hqslam/core/projection.h"
#include "hqslam/sim/drive.h"
#include "parts.h"
#include "scans.h"

namespace hqslam::python {
namespace {

using sim::SimulatedScan;
using Simulator = Guarded<sim::DriveSimulator>;

void make_simulator(Simulator* self, const std::string& drive, const SensorModel& sensor,
                    std::uint64_t seed, std::optional<std::int64_t> scans,
                    const std::string& sensor_errors) {
  sim::DriveSpec spec = sim::drive_preset(drive);
  spec.seed = seed;
  spec.scans = scans.value_or(spec.scans);
  spec.sensor_errors = sim::sensor_errors_named(sensor_errors);
  const nb::gil_scoped_release others_go_on;
  new (self) Simulator(sim::DriveSimulator(spec, sensor));
}

SimulatedScan next_scan(Simulator& simulator) {
  auto scan = simulator.call([](auto& drive) { return drive.next(); });
  if (!scan) throw nb::stop_iteration();
  return std::move(*scan);
}

}  // namespace

void add_simulation(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<SimulatedScan>(module, "SimulatedScan", "A scan with the truth.")
      .def_prop_ro(
          "range_m",
          [](SimulatedScan& s) { return view(s.image.range_m, s.image.rows, s.image.columns); },
          "(rows, columns) float32, metres; captured column after column while the sensor moved.")
      .def_ro("stamp_s", &SimulatedScan::stamp_s, "The time of its middle, seconds.")
      .def_prop_ro(
          "T_map_sensor", [](const SimulatedScan& s) { return matrix_of(s.T_map_sensor); },
          "(4, 4) float64: the true pose at stamp_s; the first scan's is the identity.")
      .def_prop_ro(
          "T_map_sensor_at_column",
          [](const SimulatedScan& s) { return pose_list(s.T_map_sensor_at_column); }, kOwned,
          "(columns, 4, 4) float64: the true pose when each column was measured.");

  module.def("drive_preset_names", &sim::drive_preset_names, "The drives there are.");
  nb::class_<Simulator>(
      module, "DriveSimulator",
      "A sensor that is driven through a simulated city: `for scan in simulator`.")
      .def("__init__", &make_simulator, "drive"_a, "sensor"_a, "seed"_a = 1, "scans"_a = nb::none(),
           "sensor_errors"_a = "none",
           "drive: one of drive_preset_names. scans: none, the drive's usual number. "
           "sensor_errors: none, typical or bad. Raises Error.")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); },
          nb::sig("def __iter__(self) -> DriveSimulator"))
      .def("__next__", &next_scan)
      .def("__len__", &ask<&sim::DriveSimulator::scans, sim::DriveSimulator>)
      .def(
          "skip",
          [](Simulator& s, std::int64_t scans) { s.call([=](auto& drive) { drive.skip(scans); }); },
          "scans"_a, "Leaves out so many scans without simulating them.")
      .def_prop_ro("sensor", &ask<&sim::DriveSimulator::sensor, sim::DriveSimulator>,
                   "The sensor.");
}

}  // namespace hqslam::python
