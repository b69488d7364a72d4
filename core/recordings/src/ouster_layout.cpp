#include "ouster_layout.h"

#include <array>
#include <string_view>

namespace hqslam::recordings {

namespace {

struct Profile {
  std::string_view name;
  OusterLayout layout;
};
/// In the order of OusterProfile.
constexpr std::array<Profile, 5> kProfiles = {
    {{"LEGACY", {0, 0, 16, 4, 12, 4, 0x000FFFFF, 0, 0}},
     {"RNG19_RFL8_SIG16_NIR16", {32, 32, 12, 0, 12, 4, 0x0007FFFF, 0, 0}},
     {"RNG19_RFL8_SIG16_NIR16_DUAL", {32, 32, 12, 0, 16, 4, 0x0007FFFF, 0, 4}},
     {"RNG15_RFL8_NIR8", {32, 32, 12, 0, 4, 2, 0x7FFF, 3, 0}},
     {"FUSA_RNG15_RFL8_NIR8_DUAL", {32, 32, 12, 0, 8, 2, 0x7FFF, 3, 4}}}};

const Profile& facts(OusterProfile profile) { return kProfiles[static_cast<std::size_t>(profile)]; }

}  // namespace

std::string_view name(OusterProfile profile) { return facts(profile).name; }

const OusterLayout& layout(OusterProfile profile) { return facts(profile).layout; }

std::uint32_t frame_id(Bytes packet, OusterProfile profile) {
  switch (profile) {
    case OusterProfile::kLegacy:  // each column says it; all of a packet are of one turn
      return little_endian<std::uint16_t>(packet, 10);
    case OusterProfile::kFusaDual:
      return little_endian<std::uint32_t>(packet, 4);
    default:
      return little_endian<std::uint16_t>(packet, 2);
  }
}

std::uint64_t serial_number(Bytes packet, OusterProfile profile) {
  constexpr std::uint64_t kMask = 0xFF'FFFF'FFFF;
  switch (profile) {
    case OusterProfile::kLegacy:
      return 0;
    case OusterProfile::kFusaDual:
      return little_endian<std::uint64_t>(packet, 11) & kMask;
    default:
      return little_endian<std::uint64_t>(packet, 7) & kMask;
  }
}

std::size_t OusterMetadata::packet_bytes() const {
  const OusterLayout& of = layout(profile);
  const std::size_t column =
      of.column_header + of.column_footer + of.pixel * static_cast<std::size_t>(sensor.rows());
  return of.packet_header + of.packet_footer +
         column * static_cast<std::size_t>(columns_per_packet);
}

bool OusterMetadata::dual_return() const { return layout(profile).second_range_at > 0; }

}  // namespace hqslam::recordings
