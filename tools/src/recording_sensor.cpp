#include "recording_sensor.h"

#include <fmt/format.h>

#include <filesystem>

#include "hqslam/core/error.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

std::string file_of_drive(const std::string& input, const char* name) {
  const fs::path path = fs::path(input) / name;
  return fs::is_directory(input) && fs::is_regular_file(path) ? path.string() : "";
}

std::optional<SensorModel> recording_sensor(const std::string& input, const std::string& sensor) {
  const std::string& path = sensor.empty() ? file_of_drive(input, "sensor.json") : sensor;
  return path.empty() ? std::nullopt : std::optional(load_sensor(path));
}

SensorModel required_recording_sensor(const std::string& input, const std::string& sensor) {
  std::optional<SensorModel> known = recording_sensor(input, sensor);
  if (!known) {
    throw Error(
        fmt::format("{}: does not say which sensor it was recorded with; give --sensor NAME or "
                    "--sensor FILE.json",
                    input));
  }
  return *known;
}

}  // namespace hqslam::tools
