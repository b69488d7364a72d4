#pragma once

#include <cstdint>
#include <string>

#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/beam_calibration.h"
#include "pages/text_table.h"

namespace hqslam::tools {

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
/// tools/web/calibration.html: distances of rings from their surfaces, before and after.
std::string calibration_html(const CalibrationReport& report);

}  // namespace hqslam::tools
