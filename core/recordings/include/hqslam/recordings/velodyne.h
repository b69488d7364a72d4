#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::recordings {

/// The sensors whose packets are understood.
enum class VelodyneModel { kVlp16, kHdl32e, kVlp32c, kVls128, kHdl64e };

/// The name of the model's sensor preset: "vlp-16", "hdl-32e", "vlp-32c", "vls-128", "hdl-64e".
std::string_view name(VelodyneModel model);
/// The model of that name; nothing for any other.
std::optional<VelodyneModel> velodyne_model(std::string_view name);

/// Which of two returns of one laser pulse is kept.
enum class KeptReturn { kStrongest, kLast };

inline constexpr std::size_t kVelodynePacketBytes = 1206;

/// How the lasers of one very HDL-64E stand: its distances mean nothing without.
struct VelodyneCalibration {
  struct Laser {
    double elevation_rad = 0.0;
    double azimuth_offset_rad = 0.0;  ///< counter-clockwise
    double distance_m = 0.0;          ///< to be added to what is measured
    double up_m = 0.0;    ///< of the beam's beginning, across the beam, in its vertical plane
    double left_m = 0.0;  ///< and across that plane
    bool operator==(const Laser&) const = default;
  };
  std::vector<Laser> lasers;  ///< in the order of their numbers
  bool operator==(const VelodyneCalibration&) const = default;
};

/// Reads the db.xml that comes with an HDL-64E, 64 lasers. What it says of intensities and of the
/// finer corrections of distances below 25 m (distCorrectionX_, distCorrectionY_) is left out.
/// Throws Error.
VelodyneCalibration read_velodyne_calibration(const std::string& path);
/// The sensor that it is: rows by elevation, columns and limits of the preset.
SensorModel sensor_of(const VelodyneCalibration& calibration);

/// What the packets of a stream say of their sensor.
struct VelodyneStream {
  VelodyneModel model = VelodyneModel::kVlp16;
  bool dual_return = false;
  double scan_period_s = 0.1;  ///< measured; 0.1 if there are too few packets to tell
  /// Where scans are cut, in the sensor's azimuth (clockwise, 0 in front), degrees: 0, or the
  /// middle of what the sensor does not look at.
  double cut_azimuth_deg = 0.0;
  double field_of_view_deg = 360.0;
  /// What the factory byte of the packets names; nothing if that is none of the models.
  std::optional<VelodyneModel> factory_model;
  double packet_spacing_us = 0.0;  ///< median; 0 with fewer than two packets
  /// Of an HDL-64E, whose packets do not say it: to be filled in by whoever has it.
  std::optional<VelodyneCalibration> calibration;
};

/// Looks at packets from the beginning of a stream, all of kVelodynePacketBytes. The time between
/// packets tells the model: some firmware lies in the factory byte, which decides only where the
/// spacing is that of no model.
class VelodyneProbe {
 public:
  VelodyneProbe();
  ~VelodyneProbe();
  void add(const Packet& packet);
  /// `otherwise` is the model where neither spacing nor factory byte tell one. Nothing if no packet
  /// is a Velodyne's, or nothing tells the model. Throws Error for an HDL-64E with two returns.
  std::optional<VelodyneStream> result(std::optional<VelodyneModel> otherwise = std::nullopt) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Where a decoder's packets went.
struct PacketCounts {
  std::int64_t used = 0;
  std::int64_t lost = 0;     ///< never came: gaps in the sensor's own time or count
  std::int64_t late = 0;     ///< doubled or overtaken by a later one: left out
  std::int64_t foreign = 0;  ///< of another size or form: left out
};

struct VelodyneOptions {
  KeptReturn kept_return = KeptReturn::kStrongest;
  /// Whether points are computed; without them scans are only counted and timed.
  bool with_points = true;
};

/// Velodyne packets -> scans.
///
/// A scan is one turn of the head, cut at stream.cut_azimuth_deg, and where nothing came for a
/// turn; what is before the first cut, behind the last one or beside such a gap is a scan only if
/// it has three quarters of the field of view. A point's row is that of its laser, its time the
/// time of its firing by the sensor's clock, set by the time of recording; a scan's stamp is the
/// middle between its first and its last firing. Azimuths are interpolated between the blocks of a
/// packet. All beams start at the centre of the sensor (the lasers' heights above one another, up
/// to 11 mm, are left out). Pulses without return are no points; points of a range that the sensor
/// cannot measure are the projection's to drop. An HDL-64E's lasers count as firing at once, 48 us
/// for all or what the packets' spacing says; it must send one return. Sources: the models' user
/// manuals (VLP-16 63-9243, HDL-32E 63-9113, VLP-32C 63-9325, VLS-128 63-9483, HDL-64E S2
/// 63-HDL64ES2), "Data packet format" and "Firing sequence timing".
class VelodyneDecoder {
 public:
  /// `sensor` gives elevation and azimuth offset of each row; as many rows as the model has lasers.
  /// Throws Error if it has not, or if there is no calibration of an HDL-64E.
  VelodyneDecoder(const VelodyneStream& stream, const SensorModel& sensor,
                  const VelodyneOptions& options = {});
  ~VelodyneDecoder();
  VelodyneDecoder(VelodyneDecoder&&) noexcept;  ///< moved from: only assign or destroy

  /// Takes the next packet in and appends the scans that it completes.
  void add(const Packet& packet, std::vector<Scan>& completed);
  /// The recording has ended: appends what is left, if it is nearly a scan.
  void finish(std::vector<Scan>& completed);
  /// Takes a scan back that is not needed any more: its memory serves the next one.
  void reuse(Scan scan);

  const PacketCounts& counts() const;
  /// Whole turns of which no packet came. Their packets are counted too.
  std::int64_t lost_scans() const;
  /// Turns that were cut short by the beginning or the end of the recording, or by a long gap.
  std::int64_t partial_scans() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hqslam::recordings
