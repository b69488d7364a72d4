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

/// Takes the number of scans out of what drive.json says: a shorter drive is the beginning of a
/// longer one.
std::int64_t take_scans(Json& json) {
  if (!json.is_object() || !json.contains("scans")) return 0;
  const Json scans = json["scans"];
  json.erase("scans");
  return scans.is_number_integer() ? scans.get<std::int64_t>() : 0;
}

bool is_there(const TableDrive& drive) {
  const Json expected = {{"name", drive.simulated->name},
                         {"seed", drive.simulated->seed},
                         {"sensor", kSimulatedSensor}};
  Json found = drive_json(drive.recording);
  const std::int64_t scans = take_scans(found);
  if (found != expected || scans < drive.simulated->scans) return false;
  try {
    return NpyStackReader(drive.recording + "/scans.npy").images() == scans &&
           read_tum(drive.recording + "/truth.tum").size() == static_cast<std::size_t>(scans);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool prepare_drive(const TableDrive& drive, const InterruptGuard& interrupt) {
  if (!drive.simulated || is_there(drive)) return true;
  SimulateOptions options;
  options.drive = drive.simulated->name;
  options.sensor = kSimulatedSensor;
  options.out = drive.recording;
  options.scans = drive.simulated->scans;
  options.seed = drive.simulated->seed;
  return simulate_drive(options, interrupt) == kOk;
}

std::string identity_of(const TableDrive& drive) {
  Json json = drive_json(drive.recording);
  take_scans(json);
  return json.is_null() ? drive.recording : json.dump();
}

std::optional<TrajectoryFile> truth_of(const TableDrive& drive) {
  const std::string path =
      drive.reference.empty() ? file_of_drive(drive.recording, "truth.tum") : drive.reference;
  return path.empty() ? std::nullopt : std::optional(read_trajectory_file(path));
}

}  // namespace hqslam::tools
