#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <utility>

#include "hqslam/core/error.h"
#include "packets/ouster_decoder.h"
#include "streams/stream_scans.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

constexpr int kProbedOusterPackets = 2000;
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
  std::ranges::sort(paths);
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

/// Ouster's programs name the metadata of drive.pcap drive_0.json, drive_1.json and so on.
bool is_named_after(const fs::path& capture, const std::string& metadata) {
  const std::string stem = capture.stem().string();
  const std::string name = fs::path(metadata).stem().string();
  return name.starts_with(stem + '_') || name.starts_with(stem + '.');
}

/// Keeps the candidates with a property, if any has it.
void prefer(std::vector<Candidate>& candidates, const std::function<bool(const Candidate&)>& has) {
  if (candidates.size() > 1 && std::ranges::any_of(candidates, has)) {
    std::erase_if(candidates, [&](const Candidate& candidate) { return !has(candidate); });
  }
}

/// How often each serial number stands in the first packets, if they were of this profile.
std::map<std::uint64_t, int> serial_numbers(StreamReader& reader, OusterProfile profile) {
  std::map<std::uint64_t, int> found;
  MessagePackets packets = packets_ahead(reader);
  for (int i = 0; i < kProbedOusterPackets; ++i) {
    const auto packet = packets.next();
    if (!packet) break;
    if (packet->payload.size() == reader.stream().packet_bytes) {
      ++found[serial_number(packet->payload, profile)];
    }
  }
  return found;
}

/// The namespace of a topic: "/rear" of "/rear/lidar_packets".
std::string namespace_of(const std::string& topic) {
  const std::size_t last = topic.rfind('/');
  return last == std::string::npos ? "" : topic.substr(0, last);
}

/// Ouster's drivers record their metadata as a text beside the packets: "/rear/metadata" is of
/// "/rear/lidar_packets". Where there is none such, any sensor's will do; "" if there is none.
std::string text_of(const std::vector<TopicText>& texts, const Stream& stream) {
  std::string of_another;
  for (const TopicText& candidate : texts) {
    if (namespace_of(candidate.topic) == namespace_of(stream.name)) return candidate.text;
    if (of_another.empty()) of_another = candidate.text;
  }
  return of_another;
}

/// Metadata that a bag holds behind its first packets: it is searched to its end.
std::vector<TopicText> later_metadata(const std::string& path) {
  std::vector<TopicText> texts;
  const auto file = open_recording_file(path);
  while (const auto message = file->next()) {
    add_metadata(file->streams()[message->stream], *message, texts);
  }
  return texts;
}

[[noreturn]] void fail_for_metadata(const StreamReader& reader,
                                    const std::vector<Candidate>& candidates) {
  if (candidates.empty()) {
    throw Error(
        "{}: packets of {} bytes from {} have the size of an Ouster's, but no metadata for such "
        "packets are beside it; put the sensor's .json file there or give it as the sensor",
        reader.path(), reader.stream().packet_bytes, reader.stream().name);
  }
  std::string found;
  for (const Candidate& candidate : candidates) {
    found += fmt::format("{}{}", found.empty() ? "" : ", ", candidate.source);
  }
  throw Error("{}: several metadata fit its packets: {}; give one of them as the sensor",
              reader.path(), found);
}

Candidate metadata_of(StreamReader& reader, const OpenOptions& options) {
  const std::string& path = reader.path();
  if (!options.sensor.empty()) return {read_ouster_metadata(options.sensor), options.sensor};
  if (const std::string text = text_of(reader.metadata(), reader.stream()); !text.empty()) {
    return {ouster_metadata_from_json(text, path), path};
  }
  const fs::path beside = fs::path(path).replace_extension(".json");
  std::error_code error;
  if (fs::is_regular_file(beside, error)) {
    return {read_ouster_metadata(beside.string()), beside.string()};
  }
  std::vector<Candidate> candidates =
      fitting_files(beside.has_parent_path() ? beside.parent_path() : ".", reader.stream());
  prefer(candidates, [&](const Candidate& candidate) {
    const OusterMetadata& metadata = candidate.metadata;
    return metadata.serial_number != 0 &&
           serial_numbers(reader, metadata.profile).contains(metadata.serial_number);
  });
  prefer(candidates,
         [&](const Candidate& candidate) { return is_named_after(path, candidate.source); });
  if (candidates.empty() && !reader.stream().type.empty()) {
    const std::string text = text_of(later_metadata(path), reader.stream());
    if (!text.empty()) return {ouster_metadata_from_json(text, path), path};
  }
  if (candidates.size() != 1) fail_for_metadata(reader, candidates);
  return candidates.front();
}

/// The serial number of the sensor that is read, where packets have one: that of the metadata, else
/// the only one present. 0: any.
std::uint64_t serial_to_read(StreamReader& reader, const Candidate& of,
                             std::vector<std::string>& warnings) {
  const auto found = serial_numbers(reader, of.metadata.profile);
  if (found.empty() || found.contains(0)) return 0;
  if (found.contains(of.metadata.serial_number)) return of.metadata.serial_number;
  if (found.size() > 1) {
    throw Error(
        "{}: {} carries packets of {} sensors, none of them number {} of {}; give the metadata of "
        "one of them as the sensor",
        reader.path(), reader.stream().name, found.size(), of.metadata.serial_number, of.source);
  }
  if (of.metadata.serial_number != 0) {
    warnings.push_back(
        fmt::format("{}: packets of sensor {}, but {} is of sensor {}: its beams may "
                    "be off by tenths of a degree",
                    reader.path(), found.begin()->first, of.source, of.metadata.serial_number));
  }
  return found.begin()->first;
}

void require_packets_of(const Candidate& of, const Stream& stream, const std::string& path) {
  if (of.metadata.packet_bytes() == stream.packet_bytes) return;
  throw Error(
      "{}: expected packets of {} bytes ({} beams, {}, by {}), found packets of {} bytes from {}; "
      "give the metadata of this recording as the sensor",
      path, of.metadata.packet_bytes(), of.metadata.sensor.rows(), name(of.metadata.profile),
      of.source, stream.packet_bytes, stream.name);
}

}  // namespace

std::unique_ptr<StreamScans> open_ouster(StreamReader reader, const OpenOptions& options,
                                         bool with_points) {
  const std::string path = reader.path();
  if (!options.sensor.empty() && !options.sensor.ends_with(".json")) {
    throw Error(
        "{}: packets of an Ouster need the metadata of that sensor, found the preset '{}'; give "
        "the sensor's .json file, or put it beside the file",
        path, options.sensor);
  }
  const Candidate of = metadata_of(reader, options);
  require_packets_of(of, reader.stream(), path);
  RecordingInfo info;
  info.sensor = of.metadata.sensor;
  info.sensor_known = options.sensor.empty();
  info.format = fmt::format("Ouster packets, {}", name(of.metadata.profile));
  if (of.metadata.imu_profile != "LEGACY") {
    info.warnings.push_back(fmt::format(
        "{}: inertial data of the profile {} are not read; set the sensor's udp_profile_imu to "
        "LEGACY",
        path, of.metadata.imu_profile));
  }
  const DecoderOptions decoding = {options.kept_return, with_points,
                                   serial_to_read(reader, of, info.warnings)};
  const OusterMetadata metadata = of.metadata;
  auto source = packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    if (sensor.columns == metadata.sensor.columns) {
      return std::make_unique<OusterDecoder>(metadata, decoding, path);
    }
    throw Error(
        "{}: expected the {} columns a turn of the Ouster's packets, found {}; record in another "
        "mode",
        path, metadata.sensor.columns, sensor.columns);
  });
  if (options.columns > 0) source->use_columns(options.columns);
  return source;
}

}  // namespace hqslam::recordings
