#pragma once

#include <cstdint>
#include <optional>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/packet.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::recordings {

/// How packets become scans.
struct DecoderOptions {
  KeptReturn kept_return = KeptReturn::kStrongest;  ///< kLast: of an Ouster the farther one
  /// Whether points are computed; without them scans are only counted and timed.
  bool with_points = true;
  /// Packets with another serial number are foreign, where an Ouster's profile has one; 0: none
  /// are.
  std::uint64_t serial_number = 0;
};

/// Packets of one sensor, in the order in which they came -> scans, ready for SLAM or upsampling.
class ScanAssembler {
 public:
  virtual ~ScanAssembler() = default;
  virtual const SensorModel& sensor() const = 0;
  /// Takes the next packet in; its payload is not needed afterwards.
  virtual void add(const Packet& packet) = 0;
  /// No packet follows: what is left becomes a scan if it is nearly one.
  virtual void finish() = 0;
  /// The next complete scan, or nothing: it takes more packets. Scans are counted in their names.
  /// Throws ScanError for one that cannot be understood, after which the next can be asked for.
  virtual std::optional<RecordedScan> next() = 0;
  /// Packets of inertial data are not counted here; they come with the scans.
  virtual const PacketCounts& counts() const = 0;
  virtual ImuCounts imu_counts() const { return {}; }
  /// Whole turns of which no packet came.
  virtual std::int64_t lost_scans() const = 0;
  /// Turns that were cut short by the beginning or the end of the recording, or by a long gap.
  virtual std::int64_t partial_scans() const = 0;
};

}  // namespace hqslam::recordings
