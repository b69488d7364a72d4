#pragma once

#include "hqslam/slam/scan_trace.h"
#include "traces.h"

namespace hqslam::python {

/// ScanTrace's fields by their names; those of its features as one array each, `features.point_m`.
void show_slam_trace(slam::ScanTrace trace, nb::dict arrays);

}  // namespace hqslam::python
