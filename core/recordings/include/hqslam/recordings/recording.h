#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::recordings {

/// What a stream of a capture or a bag holds.
enum class StreamKind {
  kVelodynePackets,
  kVelodynePositions,  ///< of its GPS receiver: no scans
  kOusterPackets,
  kPointClouds,
  kOther
};

/// A topic of a bag, or what one sender sent to one port of a capture.
struct Stream {
  std::string name;  ///< the topic, or "192.168.1.201:2368"
  StreamKind kind = StreamKind::kOther;
  std::string type;           ///< of a topic's messages
  std::int64_t messages = 0;  ///< or packets
  /// Of a capture's packets the most frequent size, of a topic's the first one's; 0 for what is no
  /// packets.
  std::size_t packet_bytes = 0;
  Endpoint endpoint;  ///< of a capture's stream
};

struct OpenOptions {
  /// A preset's name or a .json file (for packets of an Ouster its metadata); empty: what the
  /// recording says. What is said here wins.
  std::string sensor = {};
  /// Which stream: a topic, a port or sender:port; empty: the only one with scans.
  std::string stream = {};
  /// Columns of the images that points are put into; 0: the sensor's, by its rate of turning. For
  /// an Ouster's packets it must be 0 or as many as it sends.
  int columns = 0;
  KeptReturn kept_return = KeptReturn::kStrongest;
  /// For .npy stacks and other files of scans.
  RecordingOptions files = {};
};

/// What a recording is.
struct RecordingInfo {
  std::string kind;    ///< "pcap capture", "folder of .bin files", ...
  std::string stream;  ///< the one that was opened; empty for files of scans
  std::string format;  ///< "Velodyne packets, dual return", "Ouster packets, RNG15_RFL8_NIR8", ...
  SensorModel sensor;
  bool sensor_known = false;  ///< from the recording itself
  std::int64_t scans = 0;
  double first_stamp_s = 0.0;
  double duration_s = 0.0;
  bool has_stamps = false;       ///< from the recording, not counted from the period
  bool has_point_times = false;  ///< or points are as captured while the sensor turned
  PacketCounts packets;          ///< all 0 for what has no packets
  std::int64_t lost_scans = 0;   ///< turns of which nothing came
  std::int64_t partial_scans = 0;
  std::vector<Stream> streams;  ///< all of the file
  std::vector<std::string> warnings;
};

/// Whether this is a capture or a bag, by its first bytes: what open_recording reads beyond
/// hqslam::open_recording.
bool is_capture_or_bag(const std::string& path);

/// Opens any recording:
/// - .pcap and .pcapng captures of Velodyne and Ouster packets. An Ouster's metadata are found
///   beside the capture (the same name with .json, else the only fitting .json of the folder);
/// - whatever hqslam::open_recording reads; options.sensor must then say which sensor it is.
/// Stamps are those of the recording. source->warnings() says what a user should know.
/// Throws Error: which file, what was expected, what was found, what to do.
std::unique_ptr<ScanSource> open_recording(const std::string& path,
                                           const OpenOptions& options = {});

/// The sensor of a capture or a bag, as open_recording gives it. Throws Error.
SensorModel recording_sensor(const std::string& path, const OpenOptions& options = {});

/// The same as open_recording, and what was found out about it. Throws Error as open_recording
/// does.
RecordingInfo inspect(const std::string& path, const OpenOptions& options = {});

}  // namespace hqslam::recordings
