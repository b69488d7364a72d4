#pragma once

#include <optional>
#include <string>

#include "hqslam/core/sensor_model.h"

namespace hqslam::tools {

/// A file that `hqslam simulate` or `hqslam upsample` leaves in its folder, if `input` is such a
/// folder and has it; otherwise "".
std::string file_of_drive(const std::string& input, const char* name);

/// The sensor of a recording: `sensor` (a preset's name or a .json file) or, if that is empty, the
/// sensor.json in the recording's folder. Nothing where neither says. Throws Error.
std::optional<SensorModel> recording_sensor(const std::string& input, const std::string& sensor);

/// The same where one is needed: throws Error where neither says.
SensorModel required_recording_sensor(const std::string& input, const std::string& sensor);

}  // namespace hqslam::tools
