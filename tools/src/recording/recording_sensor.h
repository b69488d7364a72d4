#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/recording.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

/// A file that `hqslam simulate` or `hqslam upsample` leaves in its folder, if `input` is such a
/// folder and has it; otherwise "".
std::string file_of_drive(const std::string& input, const char* name);

/// The sensor of a recording: the one that is named (a preset or a .json file) or, if none is, the
/// sensor.json in the recording's folder. Of a capture or a bag: as the recording says, or as is
/// said, at the rate at which it turned. Nothing where neither says. Throws Error.
std::optional<SensorModel> recording_sensor(const InputChoice& choice);

/// The same where one is needed: throws Error where neither says.
SensorModel required_recording_sensor(const InputChoice& choice);

/// A capture or a bag, opened just as far as it takes to know its sensor; nullptr for other
/// recordings. Throws Error.
std::unique_ptr<recordings::StreamSource> open_stream(const InputChoice& choice);

/// Opens any recording with the sensor that recording_sensor gave, or with the rows or columns of
/// it that a network wants. Throws Error.
std::unique_ptr<ScanSource> open_input(const InputChoice& choice, const SensorModel& sensor);

/// How many scans there are: as the source says, or by reading the capture or bag to its end.
std::int64_t scans_in(const InputChoice& choice, const ScanSource& source);

/// Prints what a user should know of the recording to stderr, a line each. `input` is its path.
void print_warnings(const ScanSource& source, const std::string& input);
/// The same of what was found since the first `told` warnings, as it was read.
void print_later_warnings(const ScanSource& source, std::size_t told);

/// Throws Error if `out` is where the scans of the recording lie: results among them would be read
/// as scans by the next command.
void refuse_to_write_into_recording(const std::string& input, const std::string& out);

}  // namespace hqslam::tools
