#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "arrays.h"
#include "hqslam/recordings/recording.h"
#include "parts.h"
#include "paths.h"

namespace hqslam::python {
namespace {

using Recording = Guarded<recordings::Recording>;

RecordedScan next_scan(Recording& recording) {
  auto scan = recording.call([](auto& source) { return source.next(); });
  if (!scan) throw nb::stop_iteration();
  return std::move(*scan);
}

void open(Recording* self, const std::filesystem::path& path, const std::filesystem::path& sensor,
          const std::string& stream, int columns, bool times_from_azimuth) {
  recordings::OpenOptions options;
  options.sensor = sensor.string();
  options.stream = stream;
  options.columns = columns;
  if (times_from_azimuth) options.files.capture = CaptureTime::kRolling;
  const OthersGoOn others_go_on;
  new (self) Recording(recordings::Recording::open(path.string(), options));
}

}  // namespace

void add_recordings(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<RecordedScan>(module, "RecordedScan", "One scan of a recording.")
      .def_ro("name", &RecordedScan::name, "The file, or the stack and the index in it.")
      .def_ro("stamp_s", &RecordedScan::stamp_s, "The time of its middle, seconds.")
      .def_ro("cloud", &RecordedScan::cloud, "Its points.")
      .def_prop_ro(
          "imu",
          [](const RecordedScan& r) {
            return owned<ImuList>(std::vector(r.imu), {r.imu.size(), 7});
          },
          kOwned,
          "(N, 7) float64: what an inertial sensor measured since the scan before, in the LiDAR's "
          "frame: stamp, angular rate x, y, z (rad/s), specific force x, y, z (m/s^2).")
      .def_ro("invalid_points", &RecordedScan::invalid_points,
              "Points that were not finite or at the origin: left out.");

  nb::class_<Recording>(module, "Recording",
                        "A recording, read once, scan by scan: `for scan in recording`. A scan "
                        "that cannot be understood raises ScanError; next(recording) goes on.")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); },
          nb::sig("def __iter__(self) -> Recording"))
      .def("__next__", &next_scan)
      .def_prop_ro(
          "sensor", [](Recording& r) { return r.call([](auto& s) { return s.sensor(); }); },
          "The sensor that recorded it.")
      .def_prop_ro(
          "size", [](Recording& r) { return r.call([](auto& s) { return s.size(); }); },
          "Number of scans; None where it is known only after the last one was read.")
      .def_prop_ro(
          "warnings", [](Recording& r) { return r.call([](auto& s) { return s.warnings(); }); },
          "What should be known of it, a line each; complete at the end.")
      .def("__init__", &open, "path"_a, "sensor"_a = "", "stream"_a = "", "columns"_a = 0,
           "times_from_azimuth"_a = false,
           "path: a capture, a bag, a folder of clouds, a stack of range images. sensor: a "
           "preset's name or a .json file, where the recording does not determine it. stream: a "
           "topic, or "
           "a port. columns: of the images that packets are put into. times_from_azimuth: points "
           "of files without times were captured while the sensor turned. Raises Error.");
  module.attr("open_recording") = module.attr("Recording");
}

}  // namespace hqslam::python
