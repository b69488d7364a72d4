#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/live/live.h"
#include "hqslam/recordings/ouster.h"
#include "hqslam/recordings/velodyne.h"
#include "scan_assembler.h"

namespace hqslam::live {

/// Recognizes the sensor that the user named among the senders to a port, and its packets. Any
/// sender may send anything, so each is judged by its own packets alone.
class LiveStream {
 public:
  /// Throws Error if the sensor is unknown.
  explicit LiveStream(const LiveOptions& options);

  /// The port to which such a sensor sends by default.
  std::uint16_t usual_port() const;
  /// The port of inertial data, once the sensor is recognized; 0: none.
  std::uint16_t imu_port() const;
  /// Whether the packet is one of the sensor's inertial data.
  bool is_imu(const recordings::Packet& packet) const;
  NamedSensor named() const { return {named_, !is_ouster_ || metadata_, metadata_.has_value()}; }
  /// Takes the next packet; returns whether its sender is now recognized as the sensor. May request
  /// an Ouster's metadata from the sender.
  bool recognize(const recordings::Packet& packet);
  /// As LiveSensor::complaint().
  std::string complaint() const;

  /// The sensor's present address, once it is recognized.
  const recordings::Endpoint& sender() const { return *sender_; }
  /// Whether the packet is the sensor's. Where the sensor is silent it may send on from another
  /// address: then sender() changes.
  bool is_sensors(const recordings::Packet& packet);

  const SensorModel& sensor() const { return sensor_; }
  const std::string& format() const { return format_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::string& metadata_text() const { return metadata_text_; }
  /// Makes scans of its packets. `columns`: of the images, 0: those of sensor(). Throws Error.
  std::unique_ptr<recordings::ScanAssembler> assembler(int columns);

 private:
  /// The packets from one address.
  struct Sender {
    std::int64_t packets = 0;
    std::size_t last_bytes = 0;  ///< of its last packet
    std::string complaint;       ///< why it is not the sensor
    std::int64_t asked_ns = 0;   ///< time of the last request for metadata
    recordings::VelodyneProbe probe;
    std::optional<std::int64_t> first_us;  ///< by the sensor's clock
    std::int64_t understood = 0;
    std::int64_t first_ns = 0;  ///< when the first of these came
  };
  Sender& heard(const recordings::Packet& packet);
  bool understood(const recordings::Packet& packet) const;
  bool recognize_ouster(const recordings::Packet& packet, Sender& sender);
  bool recognize_velodyne(const recordings::Packet& packet, Sender& sender);
  bool ask_for_metadata(const recordings::Packet& packet, Sender& sender);

  LiveOptions options_;
  SensorModel named_;  ///< by the user
  bool is_ouster_ = false;
  std::optional<recordings::OusterMetadata> metadata_;
  std::string metadata_text_;

  std::map<recordings::Endpoint, Sender> senders_;
  std::optional<recordings::Endpoint> sender_;
  std::int64_t last_ns_ = 0;         ///< when its last packet came
  std::uint64_t serial_number_ = 0;  ///< which its packets must name; 0: any
  std::optional<recordings::VelodyneStream> velodyne_;
  SensorModel sensor_;
  std::string format_;
  std::vector<std::string> warnings_;
};

}  // namespace hqslam::live
