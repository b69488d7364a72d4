#include "table/table_drive.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include "files/content_hash.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/sensor_model.h"
#include "recording/recording_choice.h"
#include "simulate/simulate_command.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// The stack of range images behind a path, "" if it is none.
std::string stack_of(const std::string& recording) {
  if (fs::path(recording).extension() == ".npy") return recording;
  return file_of_drive(recording, "scans.npy");
}

std::string stack_identity(const std::string& path, std::int64_t scans) {
  NpyStackReader reader(path);
  ContentHash hash;
  for (std::int64_t i = 0; i < std::min(scans, reader.images()); ++i) {
    const RangeImage image = reader.read(i);
    hash.add({reinterpret_cast<const char*>(image.range_m.data()),
              image.range_m.size() * sizeof(float)});
  }
  return "images " + hash.digits();
}

/// The hash of the timestamps.txt in a folder, "" without it.
std::string times_identity(const fs::path& folder) {
  const fs::path path = folder / "timestamps.txt";
  std::error_code error;
  return fs::is_regular_file(path, error) ? ", times " + content_hash(path.string()) : "";
}

/// The hash of a recording's files and of the times in the folder above them, as in KITTI's drives.
std::string files_identity(const std::string& path) {
  if (!fs::is_directory(path)) return "file " + content_hash(path);
  return "files " + folder_hash(path) + times_identity(fs::path(path) / "..");
}

/// The options of reading that change the scans of the same files; "" for the defaults.
std::string reading_identity(const InputChoice& reading) {
  const InputChoice usual;
  std::string identity;
  const auto add = [&](const char* what, const std::string& value, const std::string& if_not) {
    if (value != if_not) identity += fmt::format(", {} {}", what, value);
  };
  add("stream", reading.stream, usual.stream);
  add("return", reading.kept_return, usual.kept_return);
  add("rows", reading.row_order, usual.row_order);
  add("capture", reading.capture, usual.capture);
  std::error_code error;
  const bool is_file = fs::is_regular_file(reading.stamps, error);
  add("stamps", is_file ? content_hash(reading.stamps) : reading.stamps, usual.stamps);
  if (reading.motion_corrected) identity += ", motion-corrected";
  return identity;
}

/// The difference between a simulated drive and the drive in its folder; empty where there is none.
std::string difference_of(const TableDrive& drive) {
  const std::string& folder = drive.recording.input;
  try {
    sim::DriveSpec found = sim::read_drive_json(folder + "/drive.json");
    const std::int64_t scans = std::exchange(found.scans, drive.simulated->scans);
    if (found != *drive.simulated) return "drive.json describes another drive";
    if (scans < found.scans) return fmt::format("has {} of {} scans", scans, found.scans);
    const SensorModel sensor = load_sensor(folder + "/sensor.json");
    if (sensor_json(sensor) != sensor_json(load_sensor(kSimulatedSensor))) {
      return fmt::format("sensor.json describes another sensor than {}", kSimulatedSensor);
    }
    NpyStackReader stack(folder + "/scans.npy");
    if (stack.images() != scans)
      return fmt::format("scans.npy has {} of {} scans", stack.images(), scans);
    const RangeImage last = stack.read(scans - 1);
    if (std::ranges::all_of(last.range_m, [](float r) { return r == 0.0F; })) {
      return "scans.npy ends with scans without a return, as after a crash of the machine";
    }
    if (std::ssize(read_tum(folder + "/truth.tum")) != scans) return "truth.tum is damaged";
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

bool is_there(const TableDrive& drive) { return !drive.simulated || difference_of(drive).empty(); }

bool prepare_drive(const TableDrive& drive, const InterruptGuard& interrupt,
                   const std::function<void()>& on_scan) {
  const std::string& folder = drive.recording.input;
  const bool something_is = !file_of_drive(folder, "drive.json").empty();
  if (something_is) {
    to_stderr("hqslam-lab: {}: {}; the drive is simulated again\n", folder, difference_of(drive));
  }
  SimulateOptions options;
  options.drive = drive.simulated->name;
  options.sensor = kSimulatedSensor;
  options.out = folder;
  options.scans = drive.simulated->scans;
  options.seed = drive.simulated->seed;
  options.sensor_errors = sim::name_of(drive.simulated->sensor_errors);
  options.replaces_damaged = something_is;
  return simulate_drive(options, interrupt, on_scan) == kOk;
}

std::string identity_of(const TableDrive& drive, std::int64_t scans) {
  const std::string& input = drive.recording.input;
  const std::string stack = stack_of(input);
  return (stack.empty() ? files_identity(input)
                        : stack_identity(stack, scans) + times_identity(input)) +
         reading_identity(drive.recording);
}

std::optional<TrajectoryFile> truth_of(const TableDrive& drive) {
  const std::string path =
      drive.reference.empty() ? file_of_drive(drive.recording.input, "truth.tum") : drive.reference;
  return path.empty() ? std::nullopt : std::optional(read_trajectory_file(path));
}

}  // namespace hqslam::tools
