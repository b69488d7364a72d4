
#include <bit>

#include "captures.h"

namespace hqslam::test {

std::string ouster_metadata_text(recordings::OusterProfile profile, int rows) {
  std::string altitude;
  std::string azimuth;
  for (int row = 0; row < rows; ++row) {
    altitude += fmt::format("{}{}", row == 0 ? "" : ", ", 10.0 - 20.0 * row / (rows - 1));
    azimuth += fmt::format("{}{}", row == 0 ? "" : ", ", row % 2 == 0 ? 2.0 : -1.0);
  }
  return fmt::format(
      R"({{"beam_altitude_angles": [{}], "beam_azimuth_angles": [{}], "lidar_mode": "512x20",
 "lidar_origin_to_beam_origin_mm": 20.0, "prod_line": "OS-1-8", "prod_sn": "77",
 "data_format": {{"columns_per_frame": 512, "columns_per_packet": 16, "pixels_per_column": {},
                  "column_window": [0, 511], "udp_profile_lidar": "{}"}}}})",
      altitude, azimuth, rows, recordings::name(profile));
}

std::vector<Captured> ouster_turn(recordings::OusterProfile profile, std::uint32_t frame_id,
                                  int rows) {
  return ouster_turn(
      recordings::ouster_metadata_from_json(ouster_metadata_text(profile, rows), "a test"),
      frame_id, [](int row, int column) { return 2000 + 10 * row + column; });
}

std::vector<Captured> ouster_turn(const recordings::OusterMetadata& metadata,
                                  std::uint32_t frame_id,
                                  const std::function<std::uint32_t(int, int)>& of_pixel_mm) {
  using recordings::OusterProfile;
  const OusterProfile profile = metadata.profile;
  const int rows = metadata.sensor.rows();
  const int columns = metadata.sensor.columns;
  const bool legacy = profile == OusterProfile::kLegacy;
  const bool fusa = profile == OusterProfile::kFusaDual;
  const std::size_t header = legacy ? 16 : 12;
  const std::size_t pixel = profile == OusterProfile::kRng15       ? 4
                            : fusa                                 ? 8
                            : profile == OusterProfile::kRng19Dual ? 16
                                                                   : 12;
  const std::size_t column_bytes = header + pixel * rows + (legacy ? 4 : 0);
  std::vector<Captured> packets;
  for (int first = 0; first < columns; first += 16) {
    Payload bytes(metadata.packet_bytes());
    if (fusa) {
      put(bytes, 4, frame_id);
    } else if (!legacy) {
      put(bytes, 0, std::uint16_t{1});
      put(bytes, 2, static_cast<std::uint16_t>(frame_id));
    }
    const std::uint64_t turn_ns = std::llround(1e9 * metadata.sensor.scan_period_s);
    const auto time_of = [&](int column) {
      return 5'000'000'000 + frame_id * turn_ns +
             static_cast<std::uint64_t>(column) * turn_ns / columns;
    };
    for (int i = 0; i < 16; ++i) {
      const int column = first + i;
      const std::size_t at = (legacy ? 0 : 32) + column_bytes * i;
      put(bytes, at, time_of(column));
      put(bytes, at + 8, static_cast<std::uint16_t>(column));
      if (legacy) {
        put(bytes, at + 10, static_cast<std::uint16_t>(frame_id));
        put(bytes, at + column_bytes - 4, std::uint32_t{0xFFFFFFFF});
      } else {
        put(bytes, at + 10, std::uint16_t{1});
      }
      for (int row = 0; row < rows; ++row) {
        const std::size_t p = at + header + pixel * row;
        const std::uint32_t range_mm = of_pixel_mm(row, column);
        if (pixel == 4 || pixel == 8) {
          put(bytes, p, static_cast<std::uint16_t>(range_mm / 8 | 0x8000));  // and a flag
        } else {
          put(bytes, p, range_mm | 0xFF000000U);  // and what is no range
        }
        if (fusa) put(bytes, p + 4, static_cast<std::uint16_t>((range_mm + 500) / 8));
        if (pixel == 16) put(bytes, p + 4, range_mm + 500);
      }
    }
    packets.push_back({1'600'000'000'000'000'000 + static_cast<std::int64_t>(time_of(first)), 7502,
                       std::move(bytes)});
  }
  return packets;
}

std::vector<Captured> ouster_turns(recordings::OusterProfile profile,
                                   const std::vector<std::uint32_t>& frame_ids) {
  std::vector<Captured> packets;
  for (const std::uint32_t id : frame_ids)
    std::ranges::move(ouster_turn(profile, id), std::back_inserter(packets));
  return packets;
}

Payload ouster_imu_packet(std::int64_t time_ns) {
  Payload bytes(48);
  put(bytes, 0, static_cast<std::uint64_t>(time_ns) + 1'000'000'000);  // since it was switched on
  put(bytes, 8, static_cast<std::uint64_t>(time_ns) - 222'000);
  put(bytes, 16, static_cast<std::uint64_t>(time_ns));
  const auto number = [&](std::size_t at, float value) {
    put(bytes, at, std::bit_cast<std::uint32_t>(value));
  };
  number(24, 0.25F);
  number(32, 1.0F);
  number(44, 90.0F);
  return bytes;
}

}  // namespace hqslam::test
