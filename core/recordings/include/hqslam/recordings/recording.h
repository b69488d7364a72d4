#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/scan_assembler.h"

namespace hqslam::recordings {

/// What a stream of a capture or a bag holds.
enum class StreamKind {
  kVelodynePackets,
  kVelodynePositions,  ///< of its GPS receiver: no scans
  kHesaiPackets,
  kRobosensePackets,
  kLslidarPackets,
  kSettings,  ///< of a RoboSense or an LSLiDAR, which its scans need
  kOusterPackets,
  kPointClouds,
  kInertialData,  ///< packets of an Ouster or sensor_msgs/Imu
  kOther
};

/// A topic of a bag, or what one sender sent to one port of a capture.
struct Stream {
  std::string name;  ///< the topic, or "192.168.1.201:2368"
  StreamKind kind = StreamKind::kOther;
  std::string type = {};      ///< of a topic's messages
  std::int64_t messages = 0;  ///< or packets
  /// Of a capture's packets the most frequent size, of a topic's the first one's; 0 for what is no
  /// packets.
  std::size_t packet_bytes = 0;
  Endpoint endpoint = {};  ///< of a capture's stream
  std::string frame = {};  ///< of a topic's first message; empty if it does not say
};

struct OpenOptions {
  /// A preset's name or a .json file (for packets of an Ouster its metadata; of a Hesai its .csv of
  /// angles; of an HDL-64E its db.xml); empty: what the recording says. What is said here wins.
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
  std::string imu_stream;  ///< or file, whose inertial data come with the scans; empty: none
  ImuCounts imu;
  double imu_rate_hz = 0.0;     ///< 0 with fewer than two samples
  std::vector<Stream> streams;  ///< all of the file
  std::vector<std::string> warnings;
};

/// The scans of one stream of a capture or a bag. It was read just as far as it takes to know which
/// sensor they are of, and is read once.
class StreamSource : public ScanSource {
 public:
  /// Puts points into images of so many columns (see OpenOptions), before the first scan is asked
  /// for. Throws Error.
  virtual void use_columns(int columns) = 0;
  /// What is known of it by now: how many scans there are, how long they last and what was lost,
  /// only once all were read.
  virtual RecordingInfo info() const = 0;
};

/// Whether this is a capture or a bag, by its first bytes or, damaged, its name: what open_stream
/// reads, or says what is wrong with.
bool is_capture_or_bag(const std::string& path);

/// Opens a .pcap or .pcapng capture of Velodyne, Hesai, RoboSense, LSLiDAR and Ouster packets, or a
/// bag of packets or point clouds, whose sensor is found in the points where options.sensor does
/// not say it. An Ouster's metadata are found in the bag or beside the file (the same name with
/// .json, else the only fitting .json of the folder), a Hesai's angles beside it (the same name
/// with .csv or _angles.csv). Stamps are those of the recording. Streams that begin more than two
/// seconds behind the first one are not looked for, unless they are named. Throws Error: which
/// file, what was expected, what was found, what to do; also next(), at the end, where there was
/// not one whole scan.
std::unique_ptr<StreamSource> open_stream(const std::string& path, const OpenOptions& options = {});

/// Opens any recording: what open_stream reads, or whatever hqslam::open_recording does, with the
/// inertial data of a simulated drive. Images without a sensor.json need options.sensor.
/// source->warnings() says what a user should know. Throws Error.
std::unique_ptr<ScanSource> open_recording(const std::string& path,
                                           const OpenOptions& options = {});

/// The source of a recording at `path`, with the samples of the imu.csv that `hqslam-lab simulate`
/// wrote there; as it is where there is none. Throws Error.
std::unique_ptr<ScanSource> with_imu_of_drive(std::unique_ptr<ScanSource> source,
                                              const std::string& path);

/// What was found out about a recording of any kind, which is read to its end, but for files of
/// scans, of which the first hundred tell; scans that cannot be understood are counted in a
/// warning, which says what is wrong with the first of them. Throws Error as open_recording does.
RecordingInfo inspect(const std::string& path, const OpenOptions& options = {});

}  // namespace hqslam::recordings
