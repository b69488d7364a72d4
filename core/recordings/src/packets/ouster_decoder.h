#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/organized_cloud.h"
#include "imu_queue.h"
#include "packets/ouster_metadata.h"
#include "packets/sensor_clock.h"
#include "scan_assembler.h"

namespace hqslam::recordings {

/// Size of a packet of inertial data in the profile LEGACY. Every lidar packet is larger.
inline constexpr std::size_t kOusterImuBytes = 48;

/// The sample of such a packet in the frame of the scans; its stamp is by the clock of the columns.
/// The lever arm of three centimetres to the origin of the beams is neglected.
/// Source: Ouster sensor documentation, "IMU data format": times of the system, of reading the
/// accelerometer and of reading the gyroscope, ns; acceleration x y z, g; angular velocity x y z,
/// degrees a second.
ImuSample ouster_imu_sample(Bytes packet, const OusterMetadata& metadata);

/// One turn as the sensor sent it: rows x columns, not de-staggered.
struct OusterFrame {
  std::uint32_t frame_id = 0;
  std::vector<std::uint32_t> range_mm;             ///< the first (strongest) return; 0: none
  std::vector<std::uint32_t> second_range_mm;      ///< empty with a single return
  std::vector<std::uint16_t> reflectivity;         ///< of the first return
  std::vector<std::uint16_t> second_reflectivity;  ///< empty with a single return
  std::vector<std::uint64_t> timestamp_ns;  ///< per column, by the sensor's clock; 0: no column
  std::vector<std::uint32_t> status;        ///< per column; bit 0: it is valid
  std::int64_t first_capture_ns = 0;        ///< of the packet that came first
  std::uint64_t first_timestamp_ns = 0;     ///< of that packet's first valid column
};

/// A frame with the time of its points.
struct OusterScan {
  double stamp_s = 0.0;         ///< the middle between its first and its last column
  double sensor_stamp_s = 0.0;  ///< that middle by the sensor's clock
  OrganizedCloud cloud;
};

/// Frames -> points in the sensor's frame: x forward, y left, z up, origin on the axis of rotation
/// at the height of the beams' origin (Ouster's own sensor frame is 36 or 38 mm below it).
class OusterGeometry {
 public:
  OusterGeometry(const OusterMetadata& metadata, const DecoderOptions& options = {});

  /// Nothing if no column of the frame is valid. Ranges beyond the sensor's are no return.
  std::optional<OusterScan> scan(const OusterFrame& frame);

 private:
  bool keeps_second(const OusterFrame& frame, std::size_t at) const;
  void set_points(const OusterFrame& frame, OrganizedCloud& cloud) const;

  OusterMetadata metadata_;
  DecoderOptions options_;
  SensorClock clock_;
  std::vector<Eigen::Vector3f> beam_;    ///< d of each pixel
  std::vector<Eigen::Vector3f> origin_;  ///< n (h - d) of each pixel
};

/// Ouster packets -> frames -> scans. Columns of lost packets stay empty. A packet of an earlier
/// frame that was overtaken is left out and counted; one that came twice counts as late.
/// Source: Ouster sensor documentation, "Lidar data packet format".
class OusterDecoder : public ScanAssembler {
 public:
  OusterDecoder(const OusterMetadata& metadata, const DecoderOptions& options = {},
                std::string name = "");

  const SensorModel& sensor() const override { return metadata_.sensor; }
  void add(const Packet& packet) override;
  void finish() override { complete(true); }
  std::optional<RecordedScan> next() override;
  /// The frames that are complete, as the sensor sent them.
  std::vector<OusterFrame> take_scans() { return std::exchange(completed_, {}); }
  const PacketCounts& counts() const override { return counts_; }
  ImuCounts imu_counts() const override { return imu_.counts(); }
  std::int64_t lost_scans() const override { return lost_scans_; }
  std::int64_t partial_scans() const override { return partial_scans_; }

 private:
  void add_lidar(const Packet& packet);
  void complete(bool at_end);
  void begin(const Packet& packet, std::uint32_t id);
  void read_columns(Bytes packet);
  void read_pixels(const std::uint8_t* pixels, int column);
  /// A column of a packet: where it begins, which one it is of the turn, its status.
  struct Column {
    const std::uint8_t* bytes = nullptr;
    std::size_t id = 0;
    std::uint32_t status = 0;
  };
  /// Nothing if the sensor marked the column as not valid.
  std::optional<Column> column(Bytes packet, int place) const;
  std::optional<Column> first_column(Bytes packet) const;
  /// Whether the first valid column of the packet has come already.
  bool seen(Bytes packet) const {
    const auto first = first_column(packet);
    return first && frame_->status[first->id] != 0;
  }
  std::size_t column_bytes() const {
    return layout_.column_header + layout_.column_footer +
           layout_.pixel * metadata_.pixels_per_column;
  }

  OusterMetadata metadata_;
  DecoderOptions options_;
  OusterLayout layout_;
  OusterGeometry geometry_;
  std::string name_;  ///< of the scans, with their numbers
  ImuQueue imu_;
  std::vector<OusterFrame> completed_;
  std::int64_t taken_ = 0;
  std::optional<OusterFrame> frame_;
  std::optional<std::uint32_t> last_id_;  ///< of the frame that is read or was read last
  bool first_frame_ = true;
  std::int64_t packets_in_frame_ = 0;
  /// The columns and packets of a turn that the sensor sends.
  int first_sent_ = 0;
  int last_sent_ = 0;
  std::int64_t packets_sent_ = 0;

  PacketCounts counts_;
  std::int64_t lost_scans_ = 0;
  std::int64_t partial_scans_ = 0;
};

}  // namespace hqslam::recordings
