#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::recordings {

/// The sensor of a stream of packets, whose model is changed to the user's.
/// wanted_sensor: a preset's name or a .json file; empty: what the stream says. columns: of the
/// images; 0: the preset's, by the rate of turning. path: stands for the recording in messages.
/// Throws Error.
SensorModel velodyne_sensor(VelodyneStream& stream, const std::string& wanted_sensor, int columns,
                            const std::string& path, std::vector<std::string>& warnings);

/// The model of the sensor that a user names, if the name says it. Throws Error for one that is not
/// there.
std::optional<VelodyneModel> named_model(const std::string& wanted_sensor);

}  // namespace hqslam::recordings
