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

namespace hqslam::live {

struct LiveOptions {
  /// A preset's name or a .json file. For an Ouster its metadata, or the preset of its kind: then
  /// the metadata are requested over HTTP from the sender of the packets. Which of several senders
  /// is the sensor: see LiveSensor.
  std::string sensor;
  std::uint16_t port = 0;  ///< UDP; 0: the metadata's, or 7502 for an Ouster, 2368 for a Velodyne
  recordings::KeptReturn kept_return = recordings::KeptReturn::kStrongest;
  /// A .pcap file that keeps the packets, an Ouster's metadata beside it; empty: none. It must not
  /// be there yet.
  std::string record = {};
  std::uint16_t http_port = 80;  ///< where an Ouster answers
  /// Complete scans that wait, at least 1; when another one comes, the oldest is dropped.
  int most_waiting = 2;
};

/// A sensor before its packets come: its rows are known, its beams and columns perhaps.
struct NamedSensor {
  SensorModel sensor;
  bool knows_beams = true;     ///< false for an Ouster without metadata
  bool knows_columns = false;  ///< true for an Ouster with metadata
};
/// sensor: as LiveOptions has it. Throws Error if it is unknown or its file is wrong.
NamedSensor named_sensor(const std::string& sensor);

/// What was received so far.
struct LiveCounts {
  recordings::PacketCounts packets;
  recordings::ImuCounts imu;
  std::string imu_failure;           ///< why inertial data cannot be received; empty: they can
  std::int64_t other_senders = 0;    ///< packets from another address: left out
  std::int64_t senders_changed = 0;  ///< how often the sensor sent on from another address
  std::int64_t scans = 0;            ///< complete
  std::int64_t dropped_scans = 0;    ///< complete ones dropped for later ones
  std::int64_t left_out_scans = 0;   ///< complete ones that could not be read
  std::int64_t lost_scans = 0;       ///< turns without any packet
  std::string first_left_out;        ///< why the first of left_out_scans could not be read
  std::string recording_failure;     ///< why no more packets are recorded; empty: they are
  std::string trouble;  ///< why no scans come: no packets, or another form; empty: they do
};

/// A scan, and when the packet that completed it arrived, since 1970.
struct LiveScan {
  RecordedScan scan;
  std::int64_t completed_ns = 0;
};

/// A sensor that sends packets now.
///
///   packets -> socket -> thread: decode, record -> at most `most_waiting` scans -> next()
///
/// Memory is bounded: scans that are not taken in time are dropped whole and counted. The sensor
/// must send to this computer already; it is not configured. Of all senders the sensor is the first
/// whose packets can be read for long enough (see recognize). Packets of others are left out; where
/// the sensor is silent for a second and such packets come from another address for half a second,
/// that is its new address. To be used by one thread at a time.
class LiveSensor {
 public:
  /// Opens the port. Throws Error: the port is in use, the sensor is unknown, a file or an option
  /// is wrong.
  explicit LiveSensor(const LiveOptions& options);
  ~LiveSensor();
  LiveSensor(const LiveSensor&) = delete;
  LiveSensor& operator=(const LiveSensor&) = delete;

  std::uint16_t port() const;
  /// Reads packets, for at most timeout_s, until those of one sender are the sensor's: half a
  /// second of the sensor's time for a Velodyne, a packet and the metadata for an Ouster. Returns
  /// whether they are. Requesting metadata from a sender may take 3 s more.
  bool recognize(double timeout_s);
  /// How many packets recognize() has seen.
  std::int64_t packets_seen() const;
  /// Why the most frequent sender is not the sensor: "" without any sender, or a line.
  std::string complaint() const;

  /// This function and all below: once recognize() has returned true.
  const SensorModel& sensor() const;
  recordings::Endpoint sender() const;
  /// "Velodyne packets, single return", ...
  std::string format() const;
  /// Warnings for the user, a line each.
  const std::vector<std::string>& warnings() const;
  /// Begins to decode. `columns`: of the images, as for OpenOptions. Throws Error, also if it has
  /// begun.
  void start(int columns = 0);
  /// The next scan, or nothing within that time. Throws Error if the port fails.
  std::optional<LiveScan> next(double timeout_s);
  LiveCounts counts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hqslam::live
