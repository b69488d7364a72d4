#include "recording/recording_sensor.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <system_error>

#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/recordings/recording.h"
#include "hqslam/sim/read_drive.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

namespace {

recordings::OpenOptions open_options(const InputChoice& choice) {
  recordings::OpenOptions options;
  options.sensor = choice.sensor;
  options.stream = choice.stream;
  options.kept_return = choice.kept_return == "last" ? recordings::KeptReturn::kLast
                                                     : recordings::KeptReturn::kStrongest;
  if (choice.row_order == "lowest-first") options.files.row_order = RowOrder::kLowestFirst;
  if (choice.motion_corrected) options.files.capture_time = CaptureTime::kMotionCorrected;
  options.files.times_from_azimuth = choice.capture == "rolling";
  options.files.stamps = choice.stamps;
  return options;
}

/// Of a simulated drive that may have been stopped; 0 where a folder is none.
std::int64_t planned_scans(const std::string& input) {
  const std::string drive = file_of_drive(input, "drive.json");
  if (drive.empty() || file_of_drive(input, "scans.npy").empty()) return 0;
  try {
    return sim::read_drive_json(drive).scans;
  } catch (const Error&) {
    return 0;  // of another version: its scans can be read all the same
  }
}

/// Of a recording that hqslam upsample began to lift and did not finish; 0 where it did.
std::int64_t scans_to_lift(const std::string& input) {
  const std::string origin = file_of_drive(input, "upsample.json");
  if (origin.empty()) return 0;
  constexpr std::size_t kMostBytes = 1U << 16U;
  try {
    JsonFields fields(whole_file(origin, "an upsample.json", kMostBytes), origin);
    const bool unfinished = fields.has("complete") && !fields.boolean("complete");
    return unfinished ? fields.integer("scans_in_recording") : 0;
  } catch (const Error&) {
    return 0;  // its scans can be read all the same
  }
}

}  // namespace

std::string file_of_drive(const std::string& input, const char* name) {
  const fs::path path = fs::path(input) / name;
  return fs::is_directory(input) && fs::is_regular_file(path) ? path.string() : "";
}

std::optional<SensorModel> recording_sensor(const InputChoice& choice) {
  if (recordings::is_capture_or_bag(choice.input)) {
    return open_stream(choice)->sensor();
  }
  const std::string path =
      choice.sensor.empty() ? file_of_drive(choice.input, "sensor.json") : choice.sensor;
  return path.empty() ? std::nullopt : std::optional(load_sensor(path));
}

SensorModel required_recording_sensor(const InputChoice& choice) {
  std::optional<SensorModel> known = recording_sensor(choice);
  if (known) return *known;
  return recordings::open_recording(choice.input)->sensor();  // says what is missing
}

std::unique_ptr<recordings::StreamSource> open_stream(const InputChoice& choice) {
  if (!recordings::is_capture_or_bag(choice.input)) return nullptr;
  return recordings::open_stream(choice.input, open_options(choice));
}

std::unique_ptr<ScanSource> open_input(const InputChoice& choice, const SensorModel& sensor) {
  recordings::OpenOptions options = open_options(choice);
  if (recordings::is_capture_or_bag(choice.input)) {
    if (!choice.stamps.empty()) {
      throw Error(fmt::format("{}: has stamps of its own; leave --stamps out", choice.input));
    }
    options.columns = sensor.columns;
    return recordings::open_stream(choice.input, options);
  }
  if (choice.stream.empty()) return open_recording(choice.input, sensor, options.files);
  throw Error(fmt::format("{}: is no capture and no bag, which have streams; leave --stream out",
                          choice.input));
}

std::int64_t scans_in(const InputChoice& choice, const ScanSource& source) {
  if (const auto size = source.size()) return *size;
  return recordings::inspect(choice.input, open_options(choice)).scans;
}

void print_warnings(const ScanSource& source, const std::string& input) {
  const std::int64_t size = source.size().value_or(std::numeric_limits<std::int64_t>::max());
  if (const std::int64_t planned = planned_scans(input); size < planned) {
    to_stderr(
        "hqslam: {}: the simulation was stopped after {} of {} scans; the same hqslam simulate "
        "makes them all\n",
        input, size, planned);
  }
  if (const std::int64_t planned = scans_to_lift(input); size < planned) {
    to_stderr(
        "hqslam: {}: hqslam upsample was stopped after {} of {} scans; the same command makes them "
        "all\n",
        input, size, planned);
  }
  print_later_warnings(source, 0);
}

void print_later_warnings(const ScanSource& source, std::size_t told) {
  const std::vector<std::string> warnings = source.warnings();
  for (std::size_t i = told; i < warnings.size(); ++i) to_stderr("hqslam: {}\n", warnings[i]);
}

void refuse_to_write_into_recording(const std::string& input, const std::string& out) {
  // KITTI's folders of scans are named by those above them.
  for (const char* scans : {"", "velodyne", "velodyne_points/data"}) {
    std::error_code error;
    if (!fs::equivalent(fs::path(input) / scans, out, error) || error) continue;
    throw Error(fmt::format("{}: holds the recording; give another --out for the results", out));
  }
}

}  // namespace hqslam::tools
