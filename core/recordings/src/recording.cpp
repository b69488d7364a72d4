#include "hqslam/recordings/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include "bag.h"
#include "hqslam/core/error.h"
#include "packet_scans.h"
#include "recording_file.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

/// What a file begins with.
enum class FileKind { kOther, kPcap, kDb3, kMcap, kRos1Bag, kBagFolder };

/// The files of a ROS 2 bag's folder, in natural order; empty if it is none.
std::vector<std::string> files_of_bag(const fs::path& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  if (!fs::is_regular_file(folder / "metadata.yaml", error)) return paths;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string extension = entry->path().extension().string();
    if (extension == ".db3" || extension == ".mcap") paths.push_back(entry->path().string());
  }
  // name_2.db3 comes before name_10.db3: numbers are not padded.
  std::sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
    return std::pair(a.size(), a) < std::pair(b.size(), b);
  });
  return paths;
}

FileKind kind_of(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return files_of_bag(path).empty() ? FileKind::kOther : FileKind::kBagFolder;
  }
  if (!fs::is_regular_file(path, error)) return FileKind::kOther;
  std::array<char, 16> head{};
  std::ifstream stream(path, std::ios::binary);
  stream.read(head.data(), head.size());
  const auto begins_with = [&](std::string_view magic) {
    return std::memcmp(head.data(), magic.data(), magic.size()) == 0;
  };
  for (const std::string_view magic :
       {std::string_view("\xD4\xC3\xB2\xA1", 4), std::string_view("\xA1\xB2\xC3\xD4", 4),
        std::string_view("\x4D\x3C\xB2\xA1", 4), std::string_view("\xA1\xB2\x3C\x4D", 4),
        std::string_view("\x0A\x0D\x0D\x0A", 4)}) {
    if (begins_with(magic)) return FileKind::kPcap;
  }
  if (begins_with("SQLite format 3")) return FileKind::kDb3;
  if (begins_with("\x89MCAP0\r\n")) return FileKind::kMcap;
  if (begins_with("#ROSBAG V2.0\n")) return FileKind::kRos1Bag;
  return FileKind::kOther;
}

std::unique_ptr<Bag> open_bag(const std::string& path, FileKind kind) {
  switch (kind) {
    case FileKind::kDb3:
      return open_db3(path);
    case FileKind::kMcap:
      return open_mcap(path);
    case FileKind::kRos1Bag:
      return open_ros1_bag(path);
    default:
      break;
  }
  std::vector<std::unique_ptr<Bag>> parts;
  for (const std::string& file : files_of_bag(path)) {
    parts.push_back(file.ends_with(".db3") ? open_db3(file) : open_mcap(file));
  }
  return chained(std::move(parts));
}

bool has_scans(const Stream& stream) {
  return stream.kind != StreamKind::kOther && stream.kind != StreamKind::kVelodynePositions;
}

bool is_named(const Stream& stream, const std::string& name) {
  return stream.name == name ||
         (stream.endpoint.port != 0 && std::to_string(stream.endpoint.port) == name);
}

std::string listed(const std::vector<Stream>& streams) {
  std::string text;
  for (const Stream& stream : streams) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", stream.name);
    if (text.size() > 500) return text + ", ...";
  }
  return text.empty() ? "none" : text;
}

/// The stream that was asked for, or the only one with scans.
Stream chosen_stream(const RecordingFile& file, const std::string& path, const std::string& name) {
  std::vector<Stream> candidates;
  for (const Stream& stream : file.streams()) {
    if (has_scans(stream) && (name.empty() || is_named(stream, name))) candidates.push_back(stream);
  }
  if (candidates.size() == 1) return candidates.front();
  if (candidates.empty() && !name.empty()) {
    throw Error(
        fmt::format("{}: expected scans in stream {}, found these streams: {}; name one of "
                    "them that has scans",
                    path, name, listed(file.streams())));
  }
  if (candidates.empty()) {
    throw Error(
        fmt::format("{}: expected packets or point clouds of a LiDAR, found none in these "
                    "streams: {}; give a recording of the sensor's data",
                    path, listed(file.streams())));
  }
  throw Error(fmt::format("{}: has several streams with scans: {}; name one of them with --stream",
                          path, listed(candidates)));
}

Opened open_stream(const std::shared_ptr<const RecordingFile>& file, const Stream& stream,
                   const std::string& path, const OpenOptions& options) {
  switch (stream.kind) {
    case StreamKind::kVelodynePackets:
      return open_velodyne(file, stream, path, options);
    case StreamKind::kOusterPackets:
      return open_ouster(file, stream, path, options);
    default:
      return open_clouds(file, stream, path, options);
  }
}

Opened open_file(const std::string& path, const OpenOptions& options) {
  const std::shared_ptr<const RecordingFile> file = open_recording_file(path);
  const Stream stream = chosen_stream(*file, path, options.stream);
  Opened opened = open_stream(file, stream, path, options);
  opened.info.kind = file->kind();
  opened.info.stream = stream.name;
  opened.info.streams = file->streams();
  return opened;
}

/// The first scan that can be understood; a warning says what was wrong with the one before all.
std::optional<RecordedScan> first_usable(ScanSource& source, RecordingInfo& info) {
  std::optional<std::string> complaint;
  while (true) {
    try {
      auto scan = source.next();
      if (complaint) info.warnings.push_back(*complaint);
      return scan;
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
      fmt::format("{}: expected a recording, found a folder with {} of them; give the path of one, "
                  "such as {}, or the --sensor of scans that lie beside them",
                  folder, paths.size(), *std::min_element(paths.begin(), paths.end())));
}

/// What only a scan itself tells; nothing if none of the first can be understood.
void describe_first_scan(const std::string& path, const SensorModel& sensor,
                         const OpenOptions& options, RecordingInfo& info) {
  const auto source = hqslam::open_recording(path, sensor, options.files);
  const std::size_t warnings = info.warnings.size();
  try {
    const auto first = first_usable(*source, info);
    if (!first) return;
    info.first_stamp_s = first->stamp_s;
    info.has_stamps = first->stamp_s != 0.0;  // counted ones begin with 0
    info.has_point_times = !first->cloud.time_offset_s.empty();
    info.format = fmt::format("{} returns in the first scan{}", first->counts.kept,
                              info.warnings.size() > warnings ? " that can be read" : "");
  } catch (const Error& error) {
    info.warnings.push_back(error.what());
  }
}

/// What core's readers open: files of scans of a sensor that must be named.
Opened open_files_of_scans(const std::string& path, const OpenOptions& options) {
  const fs::path described = fs::path(path) / "sensor.json";
  std::error_code error;
  const bool own = options.sensor.empty() && fs::is_regular_file(described, error);
  if (options.sensor.empty() && !own) {
    refuse_folder_of_recordings(path);
    throw Error(
        fmt::format("{}: does not say which sensor it was recorded with; give --sensor NAME "
                    "or --sensor FILE.json",
                    path));
  }
  Opened opened;
  RecordingInfo& info = opened.info;
  SensorModel sensor = load_sensor(own ? described.string() : options.sensor);
  if (options.columns > 0) sensor.columns = options.columns;
  opened.source = hqslam::open_recording(path, sensor, options.files);
  info.sensor = opened.source->sensor();
  info.sensor_known = own;
  info.scans = opened.source->size();
  info.duration_s = static_cast<double>(info.scans) * info.sensor.scan_period_s;
  info.warnings = opened.source->warnings();
  const fs::path extension = fs::path(path).extension();
  info.kind = fs::is_directory(path, error) ? "folder of scans"
              : extension == ".npy"         ? "stack of range images"
                                            : "file of one scan";
  describe_first_scan(path, sensor, options, info);
  return opened;
}

Opened open_any(const std::string& path, const OpenOptions& options) {
  return is_capture_or_bag(path) ? open_file(path, options) : open_files_of_scans(path, options);
}

}  // namespace

std::unique_ptr<RecordingFile> open_recording_file(const std::string& path) {
  const FileKind kind = kind_of(path);
  if (kind == FileKind::kOther) return nullptr;
  if (kind == FileKind::kPcap) return open_pcap_recording(path);
  return bag_recording(open_bag(path, kind), path);
}

bool is_capture_or_bag(const std::string& path) { return kind_of(path) != FileKind::kOther; }

std::unique_ptr<ScanSource> open_recording(const std::string& path, const OpenOptions& options) {
  return open_any(path, options).source;
}

SensorModel recording_sensor(const std::string& path, const OpenOptions& options) {
  return open_any(path, options).info.sensor;
}

RecordingInfo inspect(const std::string& path, const OpenOptions& options) {
  return open_any(path, options).info;
}

}  // namespace hqslam::recordings
