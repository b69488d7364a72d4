#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bags/message_packets.h"
#include "hqslam/core/error.h"
#include "hqslam/recordings/recording.h"
#include "imu_queue.h"
#include "scan_assembler.h"
#include "streams/stream_reader.h"

namespace hqslam::recordings {

/// The scans of one stream of a capture or a bag, counted and, at the end, checked.
class StreamScans : public ScanSource {
 public:
  const SensorModel& sensor() const override { return info_.sensor; }
  std::optional<std::int64_t> size() const override { return std::nullopt; }
  double read_share() const override { return reader_.read_share(); }
  bool has_stamps() const override { return true; }
  std::vector<std::string> warnings() const override { return info_.warnings; }
  std::optional<RecordedScan> next() override;
  /// As Recording::use_columns.
  void use_columns(int columns);
  bool has_packets() const { return reader_.stream().kind != StreamKind::kPointClouds; }
  /// As Recording::info.
  RecordingInfo info() const;

 protected:
  /// info: as it is known before the first scan.
  StreamScans(StreamReader reader, RecordingInfo info);
  /// The next scan; as next().
  virtual std::optional<RecordedScan> read() = 0;
  /// The sensor has other columns now.
  virtual void sensor_changed() {}
  /// Adds to the information, once all was read, what was lost.
  virtual void complete(RecordingInfo& /*info*/) {}
  /// Takes a message of the stream of inertial data; samples of sensor_msgs/Imu come with the
  /// scans.
  virtual void add_imu(const Message& message);
  /// The number of samples, from packets and messages.
  virtual ImuCounts imu_counts() const { return imu_.counts(); }

  StreamReader reader_;
  RecordingInfo info_;

 private:
  void end();
  void take_imu(RecordedScan& scan);

  ImuQueue imu_;
  std::int64_t imu_samples_ = 0;
  double first_imu_s_ = 0.0;
  double last_imu_s_ = 0.0;
  double last_stamp_s_ = 0.0;
  bool begun_ = false;
  bool ended_ = false;
};

/// The packets that come next, without taking them.
inline MessagePackets packets_ahead(StreamReader& reader) {
  return {reader.stream(),
          [&reader, index = std::size_t{0}]() mutable { return reader.ahead(index++); }};
}

/// The result of read(payload) for the first packet that it can decode; `sender` stands for the
/// sensor in messages. Throws Error if there is none.
template <typename Read>
auto first_packet(StreamReader& reader, const char* sender, const Read& read) {
  MessagePackets packets = packets_ahead(reader);
  while (const auto packet = packets.next()) {
    if (const auto result = read(packet->payload)) return *result;
  }
  throw Error("{}: expected packets of {}, found none that are whole; copy it again", reader.path(),
              sender);
}

/// Sets the wished number of columns. 0: those of a preset, which is for 10 turns a second, become
/// as many as its lasers fire in a turn of the sensor's period; others stay.
void set_columns(SensorModel& sensor, int wanted, bool is_preset);

/// Where beams of a named sensor look more than 1.5 degrees beside those that the packets' own has.
void warn_of_other_beams(const SensorModel& named, const SensorModel& expected,
                         const std::string& path, std::vector<std::string>& warnings);

/// Scans of packets. make(sensor): what makes scans of them.
using MakeAssembler = std::function<std::unique_ptr<ScanAssembler>(const SensorModel& sensor)>;
std::unique_ptr<StreamScans> packet_scans(StreamReader reader, RecordingInfo info,
                                          MakeAssembler make);

/// Scans of a stream of packets of a Velodyne, of a Hesai, of a RoboSense, of an Ouster, or of
/// sensor_msgs/PointCloud2. Not with_points: they are empty, just counted and timed. Throw Error.
std::unique_ptr<StreamScans> open_velodyne(StreamReader reader, const OpenOptions& options,
                                           bool with_points);
std::unique_ptr<StreamScans> open_hesai(StreamReader reader, const OpenOptions& options,
                                        bool with_points);
std::unique_ptr<StreamScans> open_robosense(StreamReader reader, const OpenOptions& options,
                                            bool with_points);
std::unique_ptr<StreamScans> open_ouster(StreamReader reader, const OpenOptions& options,
                                         bool with_points);
std::unique_ptr<StreamScans> open_clouds(StreamReader reader, const OpenOptions& options,
                                         bool with_points);

}  // namespace hqslam::recordings
