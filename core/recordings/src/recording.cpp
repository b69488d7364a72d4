#include "hqslam/recordings/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "hqslam/core/error.h"
#include "stream_scans.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<StreamSource> open_stream_of(const std::string& path, const OpenOptions& options,
                                             bool with_points) {
  if (!options.files.stamps.empty()) {
    throw Error("{}: a capture or a bag has its own stamps; leave --stamps {} out", path,
                options.files.stamps);
  }
  StreamReader reader(path, options.stream);
  if (with_points) reader.skip_others();
  switch (reader.stream().kind) {
    case StreamKind::kVelodynePackets:
      return open_velodyne(std::move(reader), options, with_points);
    case StreamKind::kHesaiPackets:
      return open_hesai(std::move(reader), options, with_points);
    case StreamKind::kRobosensePackets:
      return open_robosense(std::move(reader), options, with_points);
    case StreamKind::kLslidarPackets:
      return open_lslidar(std::move(reader), options, with_points);
    case StreamKind::kOusterPackets:
      return open_ouster(std::move(reader), options, with_points);
    default:
      return open_clouds(std::move(reader), options, with_points);
  }
}

/// The next scan that can be understood, as long as there is one; a warning says what was wrong
/// with the first one that cannot.
std::optional<RecordedScan> next_usable(ScanSource& source, std::optional<std::string>& complaint) {
  while (true) {
    try {
      return source.next();
    } catch (const ScanError& error) {
      if (!complaint) complaint = error.what();
    }
  }
}

/// A folder of captures or bags was meant to be one of them.
void refuse_folder_of_recordings(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_capture_or_bag(entry->path().string())) paths.push_back(entry->path().string());
  }
  if (paths.empty()) return;
  throw Error(
      "{}: expected a recording, found a folder with {} of them; give the path of one, such as {}, "
      "or the --sensor of scans that lie beside them",
      folder, paths.size(), *std::ranges::min_element(paths));
}

/// Files of scans of the sensor that is named, else that the folder describes, else that the points
/// tell of.
std::unique_ptr<ScanSource> open_files(const std::string& path, const OpenOptions& options) {
  const fs::path described = fs::path(path) / "sensor.json";
  std::error_code error;
  std::optional<SensorModel> sensor;
  if (!options.sensor.empty()) {
    sensor = load_sensor(options.sensor);
  } else if (fs::is_regular_file(described, error)) {
    sensor = load_sensor(described.string());
  } else {
    refuse_folder_of_recordings(path);
  }
  if (options.columns > 0) {
    if (!sensor) sensor = hqslam::open_recording(path, std::nullopt, options.files)->sensor();
    sensor->columns = options.columns;
  }
  return hqslam::open_recording(path, sensor, options.files);
}

RecordingInfo inspect_files(const std::string& path, const OpenOptions& options) {
  RecordingInfo info;
  const auto source = open_files(path, options);
  info.sensor_known = options.sensor.empty();
  info.sensor = source->sensor();
  info.scans = source->size().value_or(0);
  info.duration_s = static_cast<double>(info.scans) * info.sensor.scan_period_s;
  info.has_stamps = source->has_stamps();
  info.warnings = source->warnings();
  const fs::path extension = fs::path(path).extension();
  std::error_code error;
  info.kind = fs::is_directory(path, error) ? "folder of scans"
              : extension == ".npy"         ? "stack of range images"
                                            : "file of one scan";
  std::optional<std::string> complaint;
  try {
    if (const auto first = next_usable(*source, complaint)) {
      info.first_stamp_s = first->stamp_s;
      info.has_point_times = !first->cloud.time_offset_s.empty();
      info.format = fmt::format("{} returns in the first scan{}", first->counts.kept,
                                complaint ? " that can be read" : "");
      if (complaint) info.warnings.push_back(*complaint);
    }
  } catch (const Error& wrong) {
    info.warnings.push_back(wrong.what());
  }
  return info;
}

}  // namespace

std::unique_ptr<StreamSource> open_stream(const std::string& path, const OpenOptions& options) {
  return open_stream_of(path, options, true);
}

std::unique_ptr<ScanSource> open_recording(const std::string& path, const OpenOptions& options) {
  if (is_capture_or_bag(path)) return open_stream(path, options);
  return with_imu_of_drive(open_files(path, options), path);
}

std::unique_ptr<ScanSource> with_imu_of_drive(std::unique_ptr<ScanSource> source,
                                              const std::string& path) {
  const fs::path samples = fs::path(path) / "imu.csv";
  std::error_code error;
  if (!fs::is_regular_file(samples, error)) return source;
  return with_imu(std::move(source), read_imu_csv(samples.string()), samples.string());
}

RecordingInfo inspect(const std::string& path, const OpenOptions& options) {
  if (!is_capture_or_bag(path)) return inspect_files(path, options);
  const auto source = open_stream_of(path, options, false);
  std::optional<std::string> complaint;
  while (next_usable(*source, complaint)) continue;
  RecordingInfo info = source->info();
  if (complaint) info.warnings.push_back(*complaint);
  return info;
}

}  // namespace hqslam::recordings
