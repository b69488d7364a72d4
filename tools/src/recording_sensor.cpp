#include "recording_sensor.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "hqslam/core/error.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

namespace {

recordings::OpenOptions open_options(const InputRecording& recording) {
  recordings::OpenOptions options;
  options.sensor = recording.sensor;
  options.stream = recording.stream;
  options.kept_return =
      recording.last_return ? recordings::KeptReturn::kLast : recordings::KeptReturn::kStrongest;
  options.files = recording.files;
  return options;
}

}  // namespace

std::string file_of_drive(const std::string& input, const char* name) {
  const fs::path path = fs::path(input) / name;
  return fs::is_directory(input) && fs::is_regular_file(path) ? path.string() : "";
}

std::optional<SensorModel> recording_sensor(const std::string& input, const std::string& sensor,
                                            const std::string& stream) {
  if (recordings::is_capture_or_bag(input)) {
    return recordings::recording_sensor(input, open_options({input, sensor, stream, false, {}}));
  }
  const std::string& path = sensor.empty() ? file_of_drive(input, "sensor.json") : sensor;
  return path.empty() ? std::nullopt : std::optional(load_sensor(path));
}

SensorModel required_recording_sensor(const std::string& input, const std::string& sensor,
                                      const std::string& stream) {
  std::optional<SensorModel> known = recording_sensor(input, sensor, stream);
  if (!known) {
    throw Error(
        fmt::format("{}: does not say which sensor it was recorded with; give --sensor NAME or "
                    "--sensor FILE.json",
                    input));
  }
  return *known;
}

std::unique_ptr<ScanSource> open_input(const InputRecording& recording, const SensorModel& sensor) {
  if (!recordings::is_capture_or_bag(recording.input)) {
    return open_recording(recording.input, sensor, recording.files);
  }
  recordings::OpenOptions options = open_options(recording);
  options.columns = sensor.columns;
  return recordings::open_recording(recording.input, options);
}

std::string LeftOut::text() const {
  return fmt::format("{} scan{} left out{}: {}", scans, scans == 1 ? " was" : "s were",
                     scans == 1 ? "" : ", the first of them", first);
}

std::optional<RecordedScan> next_usable(ScanSource& source, LeftOut& left_out) {
  while (true) {
    try {
      return source.next();
    } catch (const ScanError& error) {
      if (left_out.scans++ == 0) left_out.first = error.what();
    }
  }
}

void print_warnings(const ScanSource& source) {
  for (const std::string& line : source.warnings()) fmt::print(stderr, "hqslam: {}\n", line);
}

}  // namespace hqslam::tools
