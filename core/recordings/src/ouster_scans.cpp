#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "hqslam/core/error.h"
#include "hqslam/recordings/scan_assembler.h"
#include "ouster_layout.h"
#include "packet_scans.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

constexpr int kProbedPackets = 2000;
constexpr std::size_t kMaxMetadataFiles = 500;

/// Metadata that may be those of the capture.
struct Candidate {
  OusterMetadata metadata;
  std::string source;
};

/// The .json files of the capture's folder that are an Ouster's metadata for packets of this size.
std::vector<Candidate> fitting_files(const fs::path& folder, const Stream& stream) {
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".json" && paths.size() < kMaxMetadataFiles) {
      paths.push_back(entry->path().string());
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Candidate> candidates;
  for (const std::string& path : paths) {
    try {
      OusterMetadata metadata = read_ouster_metadata(path);
      if (metadata.packet_bytes() == stream.packet_bytes) candidates.push_back({metadata, path});
    } catch (const Error&) {
      continue;  // some other .json file
    }
  }
  return candidates;
}

/// How often each serial number stands in the first packets, if they were of this profile.
std::map<std::uint64_t, int> serial_numbers(const RecordingFile& file, const Stream& stream,
                                            OusterProfile profile) {
  std::map<std::uint64_t, int> found;
  const auto packets = file.packets(stream);
  for (int i = 0; i < kProbedPackets; ++i) {
    const auto packet = packets->next();
    if (!packet) break;
    if (packet->payload.size() == stream.packet_bytes) {
      ++found[serial_number(packet->payload, profile)];
    }
  }
  return found;
}

[[noreturn]] void fail_for_metadata(const std::string& path, const Stream& stream,
                                    const std::vector<Candidate>& candidates) {
  if (candidates.empty()) {
    throw Error(fmt::format(
        "{}: packets of {} bytes from {} look like an Ouster's, but no metadata for such packets "
        "are beside it; put the sensor's .json file there or give it as the sensor",
        path, stream.packet_bytes, stream.name));
  }
  std::string found;
  for (const Candidate& candidate : candidates) {
    found += fmt::format("{}{}", found.empty() ? "" : ", ", candidate.source);
  }
  throw Error(fmt::format(
      "{}: several metadata fit its packets: {}; give one of them as the sensor", path, found));
}

Candidate metadata_of(const RecordingFile& file, const Stream& stream, const std::string& path,
                      const OpenOptions& options) {
  if (!options.sensor.empty()) return {read_ouster_metadata(options.sensor), options.sensor};
  if (const std::string text = file.ouster_metadata(stream); !text.empty()) {
    return {ouster_metadata_from_json(text, path), path};
  }
  const fs::path beside = fs::path(path).replace_extension(".json");
  std::error_code error;
  if (fs::is_regular_file(beside, error)) {
    return {read_ouster_metadata(beside.string()), beside.string()};
  }
  std::vector<Candidate> candidates =
      fitting_files(beside.has_parent_path() ? beside.parent_path() : ".", stream);
  if (candidates.size() > 1) {
    std::vector<Candidate> same_sensor;
    for (const Candidate& candidate : candidates) {
      const OusterMetadata& metadata = candidate.metadata;
      if (metadata.serial_number != 0 &&
          serial_numbers(file, stream, metadata.profile).contains(metadata.serial_number)) {
        same_sensor.push_back(candidate);
      }
    }
    if (!same_sensor.empty()) candidates = std::move(same_sensor);
  }
  if (candidates.size() != 1) fail_for_metadata(path, stream, candidates);
  return candidates.front();
}

/// Which sensor's packets are read, where packets say whose they are: that of the metadata, else
/// the one that is there. 0: any.
std::uint64_t serial_to_read(const RecordingFile& file, const Stream& stream, const Candidate& of,
                             const std::string& path, std::vector<std::string>& warnings) {
  const auto found = serial_numbers(file, stream, of.metadata.profile);
  if (found.empty() || found.contains(0)) return 0;
  if (found.contains(of.metadata.serial_number)) return of.metadata.serial_number;
  if (found.size() > 1) {
    throw Error(
        fmt::format("{}: {} carries packets of {} sensors, none of them number {} of {}; "
                    "give the metadata of one of them as the sensor",
                    path, stream.name, found.size(), of.metadata.serial_number, of.source));
  }
  if (of.metadata.serial_number != 0) {
    warnings.push_back(
        fmt::format("{}: packets of sensor {}, but {} is of sensor {}: its beams may "
                    "be off by tenths of a degree",
                    path, found.begin()->first, of.source, of.metadata.serial_number));
  }
  return found.begin()->first;
}

void require_packets_of(const Candidate& of, const Stream& stream, const std::string& path) {
  if (of.metadata.packet_bytes() == stream.packet_bytes) return;
  throw Error(fmt::format(
      "{}: expected packets of {} bytes ({} beams, {}, by {}), found packets of {} bytes from {}; "
      "give the metadata of this recording as the sensor",
      path, of.metadata.packet_bytes(), of.metadata.sensor.rows(), name(of.metadata.profile),
      of.source, stream.packet_bytes, stream.name));
}

/// By the clock that captured the frame's first packet.
double stamp_s(const OusterFrame& frame) {
  // Unsigned, because a damaged file may hold any time.
  const std::uint64_t later_ns =
      middle_ns(frame).value_or(frame.first_timestamp_ns) - frame.first_timestamp_ns;
  const std::uint64_t stamp_ns = static_cast<std::uint64_t>(frame.first_capture_ns) + later_ns;
  return 1e-9 * static_cast<double>(static_cast<std::int64_t>(stamp_ns));
}

}  // namespace

Opened open_ouster(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                   const std::string& path, const OpenOptions& options) {
  if (!options.sensor.empty() && !options.sensor.ends_with(".json")) {
    throw Error(
        fmt::format("{}: packets of an Ouster need the metadata of that sensor, found the "
                    "preset '{}'; give the sensor's .json file, or put it beside the file",
                    path, options.sensor));
  }
  const Candidate of = metadata_of(*file, stream, path, options);
  require_packets_of(of, stream, path);
  Opened opened;
  RecordingInfo& info = opened.info;
  info.sensor = of.metadata.sensor;
  info.sensor_known = options.sensor.empty();
  info.format = fmt::format("Ouster packets, {}", name(of.metadata.profile));
  info.has_stamps = true;
  info.has_point_times = true;
  if (options.columns > 0 && options.columns != info.sensor.columns) {
    throw Error(
        fmt::format("{}: an Ouster's packets have {} columns a turn, {} are asked for; "
                    "record in another mode",
                    path, info.sensor.columns, options.columns));
  }
  OusterOptions decoding;
  decoding.kept_return = options.kept_return;
  decoding.serial_number = serial_to_read(*file, stream, of, path, info.warnings);
  OusterOptions counting = decoding;
  counting.with_ranges = false;
  OusterDecoder decoder(of.metadata, counting);
  count_scans<OusterFrame>(*file, stream, decoder, stamp_s, info);
  info.lost_scans = decoder.lost_frames();
  info.partial_scans = decoder.partial_frames();
  judge_counts(stream, path, info);
  opened.source = packet_scan_source(std::move(file), stream, info,
                                     ouster_assembler(of.metadata, path, decoding));
  return opened;
}

}  // namespace hqslam::recordings
