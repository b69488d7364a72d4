#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::recordings {

/// Sensors that send such packets. Those of an HDL-64E are recognized and refused: their distances
/// mean nothing without the calibration of that unit.
enum class VelodyneModel { kVlp16, kHdl32e, kVlp32c, kVls128, kHdl64e };

/// The name of the model's sensor preset: "vlp-16", "hdl-32e", "vlp-32c", "vls-128", "hdl-64e".
std::string_view name(VelodyneModel model);
/// The model of that name; nothing for any other.
std::optional<VelodyneModel> velodyne_model(std::string_view name);

/// Which of two returns of one laser pulse is kept.
enum class KeptReturn { kStrongest, kLast };

inline constexpr std::size_t kVelodynePacketBytes = 1206;

/// The sensor of a stream of packets, as they describe it.
struct VelodyneStream {
  VelodyneModel model = VelodyneModel::kVlp16;
  bool dual_return = false;
  double scan_period_s = 0.1;  ///< measured; 0.1 if there are too few packets
  /// Where scans are cut, in the sensor's azimuth (clockwise, 0 in front), degrees: 0, or the
  /// middle of what the sensor does not look at.
  double cut_azimuth_deg = 0.0;
  double field_of_view_deg = 360.0;
  std::uint8_t factory_byte = 0;               ///< of most packets
  std::optional<VelodyneModel> factory_model;  ///< which factory_byte names; nothing: none of these
  double packet_spacing_us = 0.0;              ///< median; 0 with fewer than two packets
};

/// Determines the sensor from packets at the beginning of a stream, all of kVelodynePacketBytes.
/// The model is that of the time between packets: some firmware writes a wrong factory byte, which
/// decides only where the spacing is that of no model.
class VelodyneProbe {
 public:
  void add(const Packet& packet);
  /// `otherwise` is the model where neither spacing nor factory byte determines one. Nothing if no
  /// packet is a Velodyne's, or nothing determines the model.
  std::optional<VelodyneStream> result(std::optional<VelodyneModel> otherwise = std::nullopt) const;

 private:
  std::uint8_t factory_byte() const;
  std::optional<VelodyneModel> model_by_spacing(double spacing_us, bool dual) const;
  void set_period(VelodyneStream& stream) const;
  void set_field_of_view(VelodyneStream& stream) const;

  std::int64_t packets_ = 0;
  std::int64_t with_pairs_ = 0;
  std::array<std::int64_t, 4> banks_{};
  std::map<std::uint8_t, std::int64_t> products_;
  std::vector<std::int64_t> spacings_us_;
  std::vector<int> advances_;  ///< of the azimuth, in hundredths of a degree, over the same times
  std::array<bool, 360> seen_{};
  std::int64_t last_us_ = -1;
  int last_azimuth_ = 0;
  int last_block_azimuth_ = -1;
  int largest_jump_ = 0;  ///< of the azimuth from block to block, hundredths of a degree
};

}  // namespace hqslam::recordings
