#include "hqslam/recordings/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "hqslam/core/error.h"
#include "hqslam/core/left_out.h"
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

/// Reads the first scans and takes from them what they tell; later ones are many.
void look_at_scans(ScanSource& source, RecordingInfo& info) {
  constexpr std::int64_t kMostScans = 100;
  LeftOut left_out;
  std::string end;  // why it cannot be read on
  for (std::int64_t i = 0; i < kMostScans && end.empty(); ++i) {
    try {
      const auto scan = source.next();
      if (!scan) break;
      if (!info.format.empty()) continue;
      info.first_stamp_s = scan->stamp_s;
      info.has_point_times = !scan->cloud.time_offset_s.empty();
      info.format = fmt::format("{} returns in the first scan{}", scan->counts.kept,
                                left_out.scans > 0 ? " that can be read" : "");
    } catch (const ScanError& error) {
      left_out.add(error.what());
    } catch (const Error& error) {
      end = error.what();
    }
  }
  info.warnings = source.warnings();
  if (left_out.scans > 0) info.warnings.push_back(left_out.text());
  if (!end.empty()) {
    info.warnings.push_back(end);
  } else if (info.scans > kMostScans) {
    info.warnings.push_back(
        fmt::format("only the first {} of {} scans were looked at", kMostScans, info.scans));
  }
}

/// That hqslam-lab simulate wrote; empty where it did not.
std::vector<ImuSample> imu_of_drive(const std::string& path) {
  const fs::path samples = fs::path(path) / "imu.csv";
  std::error_code error;
  if (!fs::is_regular_file(samples, error)) return {};
  return read_imu_csv(samples.string());
}

void describe_imu(const std::vector<ImuSample>& samples, RecordingInfo& info) {
  if (samples.empty()) return;
  info.imu_stream = "imu.csv";
  info.imu.used = std::ssize(samples);
  const double duration_s = samples.back().stamp_s - samples.front().stamp_s;
  if (duration_s > 0.0) {
    info.imu_rate_hz = static_cast<double>(info.imu.used - 1) / duration_s;
  }
}

RecordingInfo inspect_files(const std::string& path, const OpenOptions& options) {
  RecordingInfo info;
  const auto source = open_files(path, options);
  info.sensor_known = options.sensor.empty();
  info.sensor = source->sensor();
  info.scans = source->size().value_or(0);
  info.duration_s = static_cast<double>(info.scans) * info.sensor.scan_period_s;
  info.has_stamps = source->has_stamps();
  const fs::path extension = fs::path(path).extension();
  std::error_code error;
  info.kind = fs::is_directory(path, error) ? "folder of scans"
              : extension == ".npy"         ? "stack of range images"
                                            : "file of one scan";
  describe_imu(imu_of_drive(path), info);
  look_at_scans(*source, info);
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
  std::vector<ImuSample> samples = imu_of_drive(path);
  if (samples.empty()) return source;
  return with_imu(std::move(source), std::move(samples), (fs::path(path) / "imu.csv").string());
}

RecordingInfo inspect(const std::string& path, const OpenOptions& options) {
  if (!is_capture_or_bag(path)) return inspect_files(path, options);
  const auto source = open_stream_of(path, options, false);
  LeftOut left_out;
  while (next_usable(*source, left_out)) continue;
  RecordingInfo info = source->info();
  if (left_out.scans > 0) info.warnings.push_back(left_out.text());
  return info;
}

}  // namespace hqslam::recordings
