#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/live/live.h"
#include "hqslam/recordings/ouster.h"
#include "hqslam/recordings/scan_assembler.h"

namespace hqslam::live {

/// What the packets that come to a port are, by the sensor that the user named and by the first of
/// them.
class LiveStream {
 public:
  /// Throws Error if the sensor is unknown.
  explicit LiveStream(const LiveOptions& options);

  /// The port to which such a sensor sends, unless it is told otherwise.
  std::uint16_t usual_port() const;
  NamedSensor named() const { return {named_, !is_ouster_ || metadata_, metadata_.has_value()}; }
  /// Takes the next packet in; whether it is known now what they are. May ask the sender for an
  /// Ouster's metadata. Throws Error if the packets are not the sensor's.
  bool recognise(const recordings::Packet& packet);

  /// Whose packets they are, as soon as one of them was the sensor's.
  const std::optional<recordings::Endpoint>& sender() const { return sender_; }
  /// Once they are recognised.
  const SensorModel& sensor() const { return sensor_; }
  const std::string& format() const { return format_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::string& metadata_text() const { return metadata_text_; }
  /// What makes scans of them. `columns`: of the images, 0: as sensor() has. Throws Error.
  std::unique_ptr<recordings::ScanAssembler> assembler(int columns);

 private:
  bool recognise_ouster(const recordings::Packet& packet);
  bool recognise_velodyne(const recordings::Packet& packet);
  void ask_for_metadata(const recordings::Packet& packet);
  [[noreturn]] void fail_for_packets(const recordings::Packet& packet) const;

  LiveOptions options_;
  SensorModel named_;  ///< by the user
  bool is_ouster_ = false;
  std::optional<recordings::OusterMetadata> metadata_;
  std::string metadata_text_;

  std::int64_t packets_ = 0;
  std::optional<recordings::Endpoint> sender_;
  std::uint64_t serial_number_ = 0;
  recordings::VelodyneProbe probe_;
  std::optional<std::int64_t> first_us_;
  std::optional<recordings::VelodyneStream> velodyne_;
  SensorModel sensor_;
  std::string format_;
  std::vector<std::string> warnings_;
};

}  // namespace hqslam::live
