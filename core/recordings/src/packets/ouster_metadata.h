#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "byte_reader.h"
#include "hqslam/recordings/ouster.h"

namespace hqslam::recordings {

/// An Ouster's smallest lidar packet: 16 columns of 8 beams would have 656 bytes. Its packets of
/// inertial data have kOusterImuBytes, a Velodyne's of positions 512.
inline constexpr std::size_t kSmallestLidarPacket = 600;

/// The places of ranges and reflectivities in a profile. A packet is a header, columns_per_packet
/// columns and a footer; a column is a header, a pixel per beam and a footer. Bytes are counted
/// from the beginning of each.
struct OusterLayout {
  std::size_t packet_header = 32;
  std::size_t packet_footer = 32;
  std::size_t column_header = 12;
  std::size_t column_footer = 0;
  std::size_t pixel = 0;
  std::size_t range_bytes = 4;
  std::uint32_t range_mask = 0;
  int range_shift = 0;              ///< ranges in units of 1 << range_shift mm
  std::size_t second_range_at = 0;  ///< 0: a single return
  std::size_t reflectivity_at = 0;  ///< behind each range
  std::size_t reflectivity_bytes = 1;
};

const OusterLayout& layout(OusterProfile profile);

/// The range at this place, mm.
inline std::uint32_t range_mm(const std::uint8_t* bytes, const OusterLayout& of) {
  const std::uint32_t word = of.range_bytes == 2
                                 ? std::uint32_t{little_endian<std::uint16_t>(bytes)}
                                 : little_endian<std::uint32_t>(bytes);
  return (word & of.range_mask) << of.range_shift;
}

/// The reflectivity of the return whose range is at this place.
inline std::uint16_t reflectivity(const std::uint8_t* bytes, const OusterLayout& of) {
  const std::uint8_t* const at = bytes + of.reflectivity_at;
  return of.reflectivity_bytes == 2 ? little_endian<std::uint16_t>(at) : *at;
}

/// The turn to which a packet belongs; the packet has the size of its profile.
std::uint32_t frame_id(Bytes packet, OusterProfile profile);

/// The sensor's serial number, 0 where the profile has none.
std::uint64_t serial_number(Bytes packet, OusterProfile profile);

/// The text of a file of metadata. Throws Error if there is no file or it is above 16 MiB.
std::string ouster_metadata_text(const std::string& path);

/// Whether a text that load_sensor can read is an Ouster's metadata.
bool is_ouster_metadata(const std::string& text);

}  // namespace hqslam::recordings
