#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/packet.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::recordings {

/// Where row 0 of the images in an .npy stack looks.
enum class RowOrder { kHighestFirst, kLowestFirst };

struct RecordingOptions {
  RowOrder row_order = RowOrder::kHighestFirst;
  /// How scans were captured. Rolling gives each point without a time that of its azimuth, for
  /// points in the order of their firing or ring after ring, and a scan without a stamp the middle
  /// of these as its stamp, counted on from scan to scan. Corrected: times that points have are
  /// left out, too. Nothing: points without times are taken as corrected for motion, with a
  /// warning, images of a stack as rolling unless the sensor's model is marked as corrected.
  std::optional<CaptureTime> capture = std::nullopt;
  /// A file with the stamp of each scan (seconds, or dates as in KITTI's timestamps.txt), or
  /// kStampsFromNames for the number in each file's name, or the seconds from scan to scan ("0.2"),
  /// where turns of the sensor were left out. Empty: the recording's own.
  std::string stamps = {};
};

/// For RecordingOptions::stamps.
inline constexpr const char* kStampsFromNames = "names";

/// What a stream of a capture or a bag holds.
enum class StreamKind {
  kVelodynePackets,
  kVelodynePositions,  ///< of its GPS receiver: no scans
  kHesaiPackets,
  kRobosensePackets,
  kSettings,  ///< of a RoboSense, which its scans need
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
  std::string frame = {};  ///< of a topic's first message; empty if it has none
};

/// What a user states about a recording; it takes precedence over the recording's own data.
struct OpenOptions {
  /// A preset's name or a .json file (for packets of an Ouster its metadata; of a Hesai its .csv of
  /// angles); empty: the recording's own.
  std::string sensor = {};
  /// The sensor of upsampled scans, with all rows, of which it may name the measured ones. Files of
  /// scans may have these rows alone, and it is the sensor of points and images whose own cannot be
  /// determined. Nothing: scans stay as they are recorded.
  std::optional<SensorModel> all_rows = std::nullopt;
  /// Which stream: a topic, a port or sender:port; empty: the only one with scans.
  std::string stream = {};
  /// Columns of the images that points are put into; 0: the sensor's, by its rate of turning. For
  /// an Ouster's packets it must be 0 or as many as it sends.
  int columns = 0;
  KeptReturn kept_return = KeptReturn::kStrongest;
  /// For .npy stacks and other files of scans.
  RecordingOptions files = {};
  /// A file of inertial data in place of the recording's own; "none": without any. Empty: the
  /// recording's own, or a simulated drive's imu.csv.
  std::string imu = {};
};

/// For OpenOptions::imu.
inline constexpr const char* kNoInertialData = "none";

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

class StreamScans;  // of a capture or a bag; not installed

/// A recording of any kind, opened once and read once, scan by scan:
/// - a .pcap or .pcapng capture of Velodyne, Hesai, RoboSense and Ouster packets, or a bag of
///   packets or point clouds, read just as far as it takes to determine its sensor. An Ouster's
///   metadata are found in the bag or beside the file (the same name with .json, else the only
///   fitting .json of the folder), a Hesai's angles beside it (the same name with .csv or
///   _angles.csv). Stamps are those of the recording. Streams that begin more than two seconds
///   after the first one are found only by name;
/// - files of scans (scan_source.h), with the inertial data of a simulated drive.
/// Opening decides sensor, rows and columns. Move-only; one object serves one thread at a time.
class Recording final : public ScanSource {
 public:
  /// Throws Error: which file, what was expected, what was found, how to mend it; also for an
  /// option that does not apply to this kind of recording.
  static Recording open(const std::string& path, const OpenOptions& options = {});
  ~Recording() override;
  Recording(Recording&&) noexcept;  ///< moved from: only assign or destroy
  Recording& operator=(Recording&&) noexcept;

  /// Of points the sensor that was stated, though their rows are found by the beams of the very
  /// unit, which may be off the stated ones by up to 1.5 degrees.
  const SensorModel& sensor() const override { return stated_ ? *stated_ : source_->sensor(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  double read_share() const override { return source_->read_share(); }
  bool has_stamps() const override { return source_->has_stamps(); }
  std::vector<std::string> warnings() const override { return source_->warnings(); }
  /// Throws Error also at the end, where there was not one whole scan, or where more should follow:
  /// a bag that was cut off, or of which files are missing.
  std::optional<RecordedScan> next() override { return source_->next(); }

  /// What is known so far: of a capture or a bag the number of scans, their duration and what was
  /// lost only once all were read.
  RecordingInfo info() const;

  /// Puts points into images of this many columns, before the first scan is read; image stacks and
  /// an Ouster's packets keep theirs. Throws Error.
  void use_columns(int columns);

 private:
  friend RecordingInfo inspect(const std::string& path, const OpenOptions& options);
  /// with_points: whether the scans of a capture or a bag have points, or are only timed.
  Recording(std::string path, OpenOptions options, bool with_points);

  std::string path_;
  OpenOptions options_;
  std::optional<SensorModel> stated_;  ///< of points
  std::unique_ptr<ScanSource> source_;
  StreamScans* stream_ = nullptr;  ///< source_, or what it reads, of a capture or a bag
};

/// Throws Error for an option that does not apply to this kind of recording, as Recording::open
/// does too.
void refuse_idle_options(const std::string& path, const OpenOptions& options);

/// Whether this is a capture or a bag, by its first bytes or, damaged, its name.
bool is_capture_or_bag(const std::string& path);

/// What can be found out about a recording of any kind. A capture or a bag is read to its end, of
/// files of scans the first hundred; scans that cannot be read are counted in a warning with the
/// reason of the first of them. Throws Error as Recording::open does.
RecordingInfo inspect(const std::string& path, const OpenOptions& options = {});

}  // namespace hqslam::recordings
