#include "hqslam/recordings/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "files/scan_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/left_out.h"
#include "hqslam/core/npy.h"
#include "ordered_scans.h"
#include "points/limit_returns.h"
#include "streams/stream_scans.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<StreamScans> open_stream(const std::string& path, const OpenOptions& options,
                                         bool with_points) {
  StreamReader reader(path, options.stream);
  if (options.files.capture && reader.stream().kind != StreamKind::kPointClouds) {
    throw Error("{}: --capture does not apply to packets, which have times; leave --capture out",
                path);
  }
  if (with_points) reader.skip_others();
  switch (reader.stream().kind) {
    case StreamKind::kVelodynePackets:
      return open_velodyne(std::move(reader), options, with_points);
    case StreamKind::kHesaiPackets:
      return open_hesai(std::move(reader), options, with_points);
    case StreamKind::kRobosensePackets:
      return open_robosense(std::move(reader), options, with_points);
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
      "or the --sensor of scans beside them",
      folder, paths.size(), *std::ranges::min_element(paths));
}

/// Whether hqslam wrote the folder: range images and their sensor.
bool is_folder_of_images(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "scans.npy", error) &&
         fs::is_regular_file(folder / "sensor.json", error);
}

/// The number of rows of a stack's images; nothing for other files.
std::optional<int> image_rows(const fs::path& path) {
  if (path.extension() == ".npy") return NpyStackReader(path.string()).rows();
  if (!is_folder_of_images(path)) return std::nullopt;
  return read_sensor_json((path / "sensor.json").string()).rows();
}

/// The sensor that is named, else that of the sensor.json in the folder, or beside a stack if it
/// has as many rows.
std::optional<SensorModel> stated_sensor(const std::string& path, const OpenOptions& options) {
  if (!options.sensor.empty()) return load_sensor(options.sensor);
  const bool is_stack = fs::path(path).extension() == ".npy";
  const fs::path described =
      (is_stack ? fs::path(path).parent_path() : fs::path(path)) / "sensor.json";
  std::error_code error;
  if (fs::is_regular_file(described, error)) {
    SensorModel sensor = load_sensor(described.string());
    if (!is_stack || sensor.rows() == image_rows(path)) return sensor;
  }
  refuse_folder_of_recordings(path);
  return std::nullopt;
}

/// As many rows of `full` as were measured by all_rows, evenly spread ones where it does not name
/// them; nothing where they are others.
std::optional<SensorModel> measured_rows_of(SensorModel full, const SensorModel& all_rows,
                                            int rows) {
  const std::optional<RowSelection> measured = all_rows.measured_rows;
  if (rows < 1 || rows >= full.rows() || (!measured && full.rows() % rows != 0)) {
    return std::nullopt;
  }
  full.measured_rows.reset();
  SensorModel result = select_rows(full, measured.value_or(selection_for(full.rows(), rows)));
  return result.rows() == rows ? std::optional(result) : std::nullopt;
}

/// The sensor of images: the one that is stated or, with the rows that they have, all_rows.
std::optional<SensorModel> sensor_of_images(const std::optional<SensorModel>& stated, int rows,
                                            const OpenOptions& options) {
  if (!options.all_rows) return stated;
  const SensorModel& full = stated ? *stated : *options.all_rows;
  if (full.rows() == rows) return full;
  return measured_rows_of(full, *options.all_rows, rows).value_or(full);
}

/// The sensor of points: the one that is stated, held against the beams that are found in them;
/// else, of upsampled scans, the weights'; else the one that is found.
FoundSensor sensor_of_points(const std::string& path, const std::optional<SensorModel>& stated,
                             const OpenOptions& options, const std::function<FoundSensor()>& find) {
  if (!stated && !options.all_rows) return find();
  const std::optional<FoundSensor> found = found_if_any(find);
  const SensorModel& full = stated ? *stated : *options.all_rows;
  if (found && options.all_rows) {
    const auto measured = measured_rows_of(full, *options.all_rows, found->sensor.rows());
    if (measured && have_same_beams(found->sensor, *measured)) {
      return {stated ? *measured : found->sensor, {}, "", false};
    }
  }
  return held_against_points(full, found, path);
}

/// Files of scans.
std::unique_ptr<ScanSource> open_files(const std::string& path, const OpenOptions& options,
                                       std::optional<SensorModel>& of_points) {
  const std::optional<SensorModel> stated = stated_sensor(path, options);
  const std::optional<int> rows = image_rows(path);
  const auto of_images = rows ? sensor_of_images(stated, *rows, options) : stated;
  const auto choose = [&](const std::function<FoundSensor()>& find) {
    FoundSensor chosen = sensor_of_points(path, stated, options, find);
    if (options.columns > 0) chosen.sensor.columns = options.columns;
    if (!chosen.is_found || options.columns > 0) of_points = chosen.sensor;
    return chosen;
  };
  return open_scan_files(path, of_images, choose, options.files);
}

/// The file that hqslam-lab simulate wrote; "" where it did not.
std::string imu_of_drive(const std::string& path) {
  const fs::path samples = fs::path(path) / "imu.csv";
  std::error_code error;
  return fs::is_regular_file(samples, error) ? samples.string() : "";
}

RecordingInfo info_of_files(const std::string& path, const OpenOptions& options,
                            const ScanSource& source) {
  RecordingInfo info;
  info.sensor_known = options.sensor.empty();
  info.sensor = source.sensor();
  info.scans = source.size().value_or(0);
  info.duration_s = static_cast<double>(info.scans) * info.sensor.scan_period_s;
  info.has_stamps = source.has_stamps();
  const fs::path extension = fs::path(path).extension();
  std::error_code error;
  info.kind = fs::is_directory(path, error) ? "folder of scans"
              : extension == ".npy"         ? "stack of range images"
                                            : "file of one scan";
  info.warnings = source.warnings();
  const std::string imu = imu_of_drive(path);
  if (imu.empty()) return info;
  const std::vector<ImuSample> samples = read_imu_csv(imu);
  info.imu_stream = "imu.csv";
  info.imu.used = std::ssize(samples);
  const double duration_s = samples.back().stamp_s - samples.front().stamp_s;
  if (duration_s > 0.0) {
    info.imu_rate_hz = static_cast<double>(info.imu.used - 1) / duration_s;
  }
  return info;
}

/// Sets what the first readable scan determines for all.
void note_first(const RecordedScan& scan, const LeftOut& left_out, RecordingInfo& info) {
  info.first_stamp_s = scan.stamp_s;
  info.has_point_times = !scan.cloud.time_offset_s.empty();
  info.format = fmt::format("{} returns in the first scan{}", scan.counts.kept,
                            left_out.scans > 0 ? " that can be read" : "");
}

}  // namespace

void refuse_idle_options(const std::string& path, const OpenOptions& options) {
  const bool is_stream = is_capture_or_bag(path);
  const bool is_stack = fs::path(path).extension() == ".npy" || is_folder_of_images(path);
  const bool is_capture = is_stream && fs::path(path).extension().string().starts_with(".pcap");
  struct Option {
    const char* name;
    bool is_given;
    bool applies;
  };
  const OpenOptions usual;
  const RecordingOptions& files = options.files;
  for (const Option& option : std::initializer_list<Option>{
           {"--stream", options.stream != usual.stream, is_stream},
           {"--return", options.kept_return != usual.kept_return, is_stream},
           {"--row-order", files.row_order != usual.files.row_order, is_stack},
           {"--capture", files.capture.has_value(), !is_capture},
           {"--stamps", !files.stamps.empty(), !is_stream}}) {
    if (!option.is_given || option.applies) continue;
    throw Error("{}: {} does not apply to {}; leave {} out", path, option.name,
                is_stream  ? "a capture or a bag"
                : is_stack ? "a stack of range images"
                           : "files of points",
                option.name);
  }
}

Recording::Recording(std::string path, OpenOptions options, bool with_points)
    : path_(std::move(path)), options_(std::move(options)) {
  refuse_idle_options(path_, options_);
  if (is_capture_or_bag(path_)) {
    auto stream = open_stream(path_, options_, with_points);
    stream_ = stream.get();
    source_ = std::move(stream);
  } else {
    source_ = open_files(path_, options_, stated_);
    if (stated_) stated_->columns = source_->sensor().columns;
  }
  const bool is_packets = stream_ != nullptr && stream_->has_packets();
  if (!is_packets) source_ = without_limit_returns(std::move(source_));
  source_ = ordered(std::move(source_), is_packets ? Repeats::kKept : Repeats::kLeftOut);
  const std::string imu = options_.imu.empty() ? imu_of_drive(path_) : options_.imu;
  if (imu == kNoInertialData) {
    source_ = with_imu(std::move(source_), {});
  } else if (!imu.empty()) {
    source_ = with_imu(std::move(source_), read_imu_csv(imu), imu);
  }
}

Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

Recording Recording::open(const std::string& path, const OpenOptions& options) {
  return {path, options, true};
}

void Recording::use_columns(int columns) {
  if (columns == sensor().columns) return;
  if (stream_ != nullptr) {
    stream_->use_columns(columns);
  } else if (!image_rows(path_)) {
    options_.columns = columns;
    *this = open(path_, options_);
  }
}

RecordingInfo Recording::info() const {
  if (stream_ == nullptr) return info_of_files(path_, options_, *this);
  RecordingInfo info = stream_->info();
  info.warnings = warnings();
  return info;
}

RecordingInfo inspect(const std::string& path, const OpenOptions& options) {
  constexpr std::int64_t kMostScansOfFiles = 100;  // later ones are many
  const bool is_stream = is_capture_or_bag(path);
  // The scans of a stream are only counted and timed.
  Recording recording(path, options, !is_stream);
  RecordingInfo first;
  LeftOut left_out;
  std::string end;  // why it cannot be read on
  try {
    for (std::int64_t i = 0; is_stream || i < kMostScansOfFiles; ++i) {
      try {
        const auto scan = recording.next();
        if (!scan) break;
        if (first.format.empty()) note_first(*scan, left_out, first);
      } catch (const ScanError& error) {
        left_out.add(error.what());
      }
    }
  } catch (const Error& error) {
    if (is_stream && recording.info().scans == 0) throw;
    end = error.what();
  }
  RecordingInfo info = recording.info();
  std::erase_if(info.warnings,
                [](const std::string& text) { return text.ends_with(kTestedByInfo); });
  if (!is_stream) {
    info.sensor = recording.source_->sensor();  // with the file's own beams
    info.first_stamp_s = first.first_stamp_s;
    info.has_point_times = first.has_point_times;
    info.format = first.format;
  }
  if (left_out.scans > 0) info.warnings.push_back(left_out.text());
  if (!end.empty()) info.warnings.push_back(end);
  if (!is_stream && end.empty() && info.scans > kMostScansOfFiles) {
    info.warnings.push_back(
        fmt::format("only the first {} of {} scans were examined", kMostScansOfFiles, info.scans));
  }
  return info;
}

}  // namespace hqslam::recordings
