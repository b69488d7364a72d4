#include <nanobind/nanobind.h>

#include "hqslam/core/error.h"
#include "others_go_on.h"
#include "parts.h"

// Arrays are float32 and metres, poses 4 x 4 float64 matrices, as in C++; docs/python.md.
NB_MODULE(_hqslam, module) {
  using namespace hqslam::python;
  namespace nb = nanobind;
  module.doc() = "LiDAR super-resolution and SLAM on plain CPUs.";

  const nb::exception<hqslam::Error> error(module, "Error", PyExc_ValueError);
  error.doc() = "Wrong input; one line: what was expected, what was found, how to mend it.";
  const nb::exception<hqslam::ScanError> scan_error(module, "ScanError", error);
  scan_error.doc() = "One scan that cannot be understood; the next one can be asked for.";

  nb::set_leak_warnings(false);  // threads that sleep at the end keep their objects
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&let_others_sleep));

  add_sensors(module);
  add_scans(module);
  add_recordings(module);
  add_trajectories(module);
  add_scan_memory(module);
  add_upsampling(module);
  add_slam(module);
  add_pipeline(module);
  add_maps(module);
  add_evaluation(module);
}
