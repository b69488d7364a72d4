#include "hqslam/recordings/recording.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "hqslam/core/error.h"
#include "packet_scans.h"
#include "recording_file.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

/// What a file begins with.
enum class FileKind { kOther, kPcap };

FileKind kind_of(const std::string& path) {
  std::error_code error;
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
  return FileKind::kOther;
}

bool has_scans(const Stream& stream) { return stream.kind != StreamKind::kOther; }

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
    throw Error(fmt::format("{}: expected scans in stream {}, found these streams: {}; name one of "
                            "them that has scans",
                            path, name, listed(file.streams())));
  }
  if (candidates.empty()) {
    throw Error(fmt::format("{}: expected packets or point clouds of a LiDAR, found none in these "
                            "streams: {}; give a recording of the sensor's data",
                            path, listed(file.streams())));
  }
  throw Error(fmt::format("{}: has several streams with scans: {}; name one of them with --stream",
                          path, listed(candidates)));
}

Opened open_file(const std::string& path, const OpenOptions& options) {
  const std::shared_ptr<const RecordingFile> file = open_recording_file(path);
  const Stream stream = chosen_stream(*file, path, options.stream);
  Opened opened = stream.kind == StreamKind::kVelodynePackets
                      ? open_velodyne(file, stream, path, options)
                      : open_ouster(file, stream, path, options);
  opened.info.kind = file->kind();
  opened.info.stream = stream.name;
  opened.info.streams = file->streams();
  return opened;
}

/// What core's readers open: files of scans of a sensor that must be named.
Opened open_files_of_scans(const std::string& path, const OpenOptions& options) {
  const fs::path described = fs::path(path) / "sensor.json";
  std::error_code error;
  const bool own = options.sensor.empty() && fs::is_regular_file(described, error);
  if (options.sensor.empty() && !own) {
    throw Error(fmt::format("{}: does not say which sensor it was recorded with; give --sensor NAME "
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
  return opened;
}

Opened open_any(const std::string& path, const OpenOptions& options) {
  return is_capture_or_bag(path) ? open_file(path, options) : open_files_of_scans(path, options);
}

}  // namespace

std::unique_ptr<RecordingFile> open_recording_file(const std::string& path) {
  return kind_of(path) == FileKind::kPcap ? open_pcap_recording(path) : nullptr;
}

bool is_capture_or_bag(const std::string& path) { return kind_of(path) != FileKind::kOther; }

std::unique_ptr<ScanSource> open_recording(const std::string& path, const OpenOptions& options) {
  return open_any(path, options).source;
}

RecordingInfo inspect(const std::string& path, const OpenOptions& options) {
  return open_any(path, options).info;
}

}  // namespace hqslam::recordings
