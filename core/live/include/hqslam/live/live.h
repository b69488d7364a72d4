#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/packet.h"
#include "hqslam/recordings/scan_assembler.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::live {

struct LiveOptions {
  /// A preset's name or a .json file. For an Ouster either its metadata,
  /// or the preset of its kind: the metadata are then asked for over HTTP where the packets come
  /// from.
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

/// What is known of a sensor before its packets come: its rows, and maybe more.
struct NamedSensor {
  SensorModel sensor;
  bool knows_beams = true;     ///< not those of an Ouster that is only named
  bool knows_columns = false;  ///< how many it sends a turn
};
/// sensor: as LiveOptions has it. Throws Error if it is unknown or its file is wrong.
NamedSensor named_sensor(const std::string& sensor);

/// What came up to now.
struct LiveCounts {
  recordings::PacketCounts packets;
  recordings::ImuCounts imu;
  std::string imu_failure;           ///< why no inertial data are received; empty: they may be
  std::int64_t other_senders = 0;    ///< packets from another address: left out
  std::int64_t senders_changed = 0;  ///< how often the sensor sent on from another address
  std::int64_t scans = 0;            ///< complete
  std::int64_t dropped_scans = 0;    ///< of these: had to make room for later ones
  std::int64_t left_out_scans = 0;   ///< of these: could not be understood
  std::int64_t lost_scans = 0;       ///< whole turns of which no packet came
  std::string first_left_out;        ///< what was wrong with the first of them
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
/// Memory is bounded: whoever does not ask for scans in time loses whole ones, which are counted.
/// The sensor must send to this computer already: it is not configured. Among all that send, the
/// sensor is the first whose packets are understood for long enough (see recognise). Packets of
/// others are left out; where the sensor is silent for a second and the same packets come from
/// another address for half a second, it has that address now. To be used by one thread at a time.
class LiveSensor {
 public:
  /// Opens the port. Throws Error: the port is in use, the sensor is unknown, a file or an option
  /// is wrong.
  explicit LiveSensor(const LiveOptions& options);
  ~LiveSensor();
  LiveSensor(const LiveSensor&) = delete;
  LiveSensor& operator=(const LiveSensor&) = delete;

  std::uint16_t port() const;
  /// Reads packets, for at most so long, until those of one sender are the sensor's: half a second
  /// of the sensor's time for a Velodyne, a packet and the metadata for an Ouster. Returns whether
  /// they are. Asking a sender for metadata may take 3 s more.
  bool recognise(double timeout_s);
  /// How many packets recognise() has seen.
  std::int64_t packets_seen() const;
  /// Why it is not recognised yet, by the sender that was heard most: "" where none was, or a line.
  std::string complaint() const;

  /// From here on: once recognise() has returned true.
  const SensorModel& sensor() const;
  recordings::Endpoint sender() const;
  /// "Velodyne packets, single return", ...
  std::string format() const;
  /// What a user should know, a line each.
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
