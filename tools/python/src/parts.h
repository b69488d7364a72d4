#pragma once

#include <nanobind/nanobind.h>

namespace hqslam::python {

// What each part of hqslam adds to the module. Later ones use the classes of earlier ones.
void add_sensors(nanobind::module_& module);
void add_scans(nanobind::module_& module);
void add_recordings(nanobind::module_& module);
void add_trajectories(nanobind::module_& module);
void add_scan_memory(nanobind::module_& module);
void add_upsampling(nanobind::module_& module);
void add_slam(nanobind::module_& module);
void add_pipeline(nanobind::module_& module);
void add_maps(nanobind::module_& module);
void add_evaluation(nanobind::module_& module);

}  // namespace hqslam::python
