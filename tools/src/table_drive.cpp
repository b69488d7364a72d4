#include "table_drive.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "exit_status.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "recording_sensor.h"
#include "simulate_command.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

/// The paper's sensor.
constexpr const char* kSimulatedSensor = "os1-64";

/// What drive.json in the folder says, null if there is none.
Json drive_json(const std::string& folder) {
  std::ifstream stream(file_of_drive(folder, "drive.json"));
  const Json json = Json::parse(stream, nullptr, /*allow_exceptions=*/false);
  return json.is_discarded() ? Json() : json;
}

bool is_whole(const TableDrive& drive) {
  const Json expected = {{"name", drive.simulated->name},
                         {"seed", drive.simulated->seed},
                         {"scans", drive.simulated->scans},
                         {"sensor", kSimulatedSensor}};
  if (drive_json(drive.recording) != expected) return false;
  const auto scans = static_cast<std::size_t>(drive.simulated->scans);
  try {
    return NpyStackReader(drive.recording + "/scans.npy").images() == drive.simulated->scans &&
           read_tum(drive.recording + "/truth.tum").size() == scans;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool prepare_drive(const TableDrive& drive, const InterruptGuard& interrupt) {
  if (!drive.simulated || is_whole(drive)) return true;
  SimulateOptions options;
  options.drive = drive.simulated->name;
  options.sensor = kSimulatedSensor;
  options.out = drive.recording;
  options.scans = drive.simulated->scans;
  options.seed = drive.simulated->seed;
  return simulate_drive(options, interrupt) == kOk;
}

std::string identity_of(const TableDrive& drive) {
  const Json json = drive_json(drive.recording);
  return json.is_null() ? drive.recording : json.dump();
}

std::optional<TrajectoryFile> truth_of(const TableDrive& drive) {
  const std::string path =
      drive.reference.empty() ? file_of_drive(drive.recording, "truth.tum") : drive.reference;
  return path.empty() ? std::nullopt : std::optional(read_trajectory_file(path));
}

}  // namespace hqslam::tools
