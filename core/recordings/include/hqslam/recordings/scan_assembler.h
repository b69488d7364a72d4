#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/ouster.h"
#include "hqslam/recordings/packet.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::recordings {

/// Of inertial samples: those that were taken in, and those that were not: a number that is not
/// finite, a time that is not later than the one before or that is far from all scans.
struct ImuCounts {
  std::int64_t used = 0;
  std::int64_t left_out = 0;
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
  /// Without packets of inertial data, which come with the scans.
  virtual const PacketCounts& counts() const = 0;
  virtual ImuCounts imu_counts() const { return {}; }
  /// Whole turns of which no packet came.
  virtual std::int64_t lost_scans() const = 0;
  /// Turns that were cut short by the beginning or the end of the recording, or by a long gap.
  virtual std::int64_t partial_scans() const = 0;
};

/// `sensor`: elevation and azimuth offset of each row, as many rows as the model has lasers, and
/// the columns of the images that points are put into. `name`: what the scans' names begin with.
/// Throws Error if the rows are others, or if there is no calibration of an HDL-64E.
std::unique_ptr<ScanAssembler> velodyne_assembler(const VelodyneStream& stream,
                                                  const SensorModel& sensor, std::string name,
                                                  const TurnDecoderOptions& options = {});

std::unique_ptr<ScanAssembler> ouster_assembler(const OusterMetadata& metadata, std::string name,
                                                const OusterOptions& options = {});

}  // namespace hqslam::recordings
