#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::tools {

/// What a user says of a recording; every command that opens one asks in the same words.
struct InputChoice {
  std::string input;
  std::string sensor = {};  ///< empty: what the recording says
  std::string stream = {};  ///< of a capture or a bag; empty: the only one with scans
  std::string kept_return = "strongest";
  std::string row_order = "highest-first";
  bool motion_corrected = false;
  std::string capture = {};  ///< "rolling": points without a time have that of their azimuth
  std::string stamps = {};   ///< a file, or "names"; empty: what the recording says
};

/// A file that `hqslam simulate` or `hqslam upsample` leaves in its folder, if `input` is such a
/// folder and has it; otherwise "".
std::string file_of_drive(const std::string& input, const char* name);

/// The sensor of a recording: `sensor` (a preset's name or a .json file) or, if that is empty, the
/// sensor.json in the recording's folder. Of a capture or a bag: as the recording says, or `sensor`
/// says, at the rate at which it turned. Nothing where neither says. Throws Error.
std::optional<SensorModel> recording_sensor(const std::string& input, const std::string& sensor,
                                            const std::string& stream = "");

/// The same where one is needed: throws Error where neither says.
SensorModel required_recording_sensor(const std::string& input, const std::string& sensor,
                                      const std::string& stream = "");

/// A capture or a bag, opened just as far as it takes to know its sensor; nullptr for other
/// recordings. Throws Error.
std::unique_ptr<recordings::StreamSource> open_stream(const InputChoice& choice);

/// Opens any recording with the sensor that recording_sensor gave, or with the rows or columns of
/// it that a network wants. Throws Error.
std::unique_ptr<ScanSource> open_input(const InputChoice& choice, const SensorModel& sensor);

/// How many scans there are: as the source says, or by reading the capture or bag to its end.
std::int64_t scans_in(const InputChoice& choice, const ScanSource& source);

/// Scans of a recording that could not be understood.
struct LeftOut {
  std::int64_t scans = 0;
  std::string first;  ///< what was wrong with the first one

  /// "2 scans were left out: ..."
  std::string text() const;
};

/// The next scan that can be understood, or nothing at the end. Throws Error where the recording
/// cannot be read on.
std::optional<RecordedScan> next_usable(ScanSource& source, LeftOut& left_out);

/// Prints what a user should know of the recording to stderr, a line each. `input` is its path.
void print_warnings(const ScanSource& source, const std::string& input);
/// The same of what was found since the first `told` warnings, as it was read.
void print_later_warnings(const ScanSource& source, std::size_t told);

}  // namespace hqslam::tools
