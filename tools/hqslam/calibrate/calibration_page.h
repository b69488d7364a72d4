#pragma once

#include <cstdint>
#include <string>

#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/beam_calibration.h"
#include "report/page.h"

namespace hqslam::tools {

/// In the head of a page of hqslam calibrate.
inline constexpr const char* kCalibrationPageMarker =
    "<meta name=\"generator\" content=\"hqslam calibrate\">";

/// What hqslam calibrate found, and from what.
struct CalibrationReport {
  std::string recording;
  SensorModel sensor;
  double path_m = 0.0;
  std::int64_t scans = 0;
  slam::BeamCalibration found;
};

/// A row per beam, with standard deviations.
TextTable beam_table(const CalibrationReport& report);
/// One line.
std::string calibration_summary(const CalibrationReport& report);
/// The page: rings against their surfaces, before and after.
std::string calibration_html(const CalibrationReport& report);

}  // namespace hqslam::tools
