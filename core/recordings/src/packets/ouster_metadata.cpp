#include "packets/ouster_metadata.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/ouster_beams.h"
#include "hqslam/core/whole_file.h"

namespace hqslam::recordings {

namespace {

struct Profile {
  std::string_view name;
  OusterLayout layout;
};
/// In the order of OusterProfile.
constexpr std::array<Profile, 5> kProfiles = {
    {{"LEGACY", {0, 0, 16, 4, 12, 4, 0x000FFFFF, 0, 0, 4, 2}},
     {"RNG19_RFL8_SIG16_NIR16", {32, 32, 12, 0, 12, 4, 0x0007FFFF, 0, 0, 4}},
     {"RNG19_RFL8_SIG16_NIR16_DUAL", {32, 32, 12, 0, 16, 4, 0x0007FFFF, 0, 4, 3}},
     {"RNG15_RFL8_NIR8", {32, 32, 12, 0, 4, 2, 0x7FFF, 3, 0, 2}},
     {"FUSA_RNG15_RFL8_NIR8_DUAL", {32, 32, 12, 0, 8, 2, 0x7FFF, 3, 4, 2}}}};

const Profile& facts(OusterProfile profile) { return kProfiles[static_cast<std::size_t>(profile)]; }

constexpr std::size_t kMaxFileBytes = 16U << 20U;

/// The text in a field; empty without one.
std::string words(JsonFields& fields, const std::string& field) {
  return fields.has(field) && fields.dumped(field).starts_with('"') ? fields.text(field) : "";
}

OusterProfile profile_of(JsonFields& format) {
  constexpr const char* kField = "udp_profile_lidar";
  // Firmware older than the profiles does not write it.
  if (words(format, kField).empty()) return OusterProfile::kLegacy;
  std::vector<std::string> names;
  for (const Profile& profile : kProfiles) names.emplace_back(profile.name);
  return static_cast<OusterProfile>(format.choice(kField, names));
}

/// Where the file does not have it: the value of the product line.
double usual_beam_origin_mm(const std::string& product) {
  if (product.starts_with("OS-0-")) return 27.67;
  if (product.starts_with("OS-1-")) return 15.806;
  if (product.starts_with("OS-2-")) return 13.762;
  return 12.163;  // the first generation, whose files name no product
}

double beam_origin_mm(JsonFields beams, const std::string& product) {
  constexpr const char* kOrigin = "lidar_origin_to_beam_origin_mm";
  constexpr const char* kTransform = "beam_to_lidar_transform";
  double result = usual_beam_origin_mm(product);
  beams.optional(kOrigin, result);
  if (beams.has(kTransform)) {  // 4 x 4, row-major; the beams begin at its translation in x
    const std::vector<double> transform = beams.numbers(kTransform);
    if (transform.size() != 16) beams.complain(kTransform, "16 numbers");
    result = transform[3];
  }
  if (!(result >= 0.0 && result < 1000.0)) beams.complain(kOrigin, "0 to 1000");
  return result;
}

void set_window(OusterMetadata& metadata, JsonFields& format) {
  constexpr const char* kWindow = "column_window";
  const int last = metadata.sensor.columns - 1;
  const std::vector<int> window =
      format.has(kWindow) ? format.integers(kWindow) : std::vector<int>{0, last};
  const bool fits = window.size() == 2 && std::ranges::all_of(window, [&](int column) {
                      return column >= 0 && column <= last;
                    });
  if (!fits) format.complain(kWindow, fmt::format("two columns, 0 to {}", last));
  metadata.first_column = window[0];
  metadata.last_column = window[1];
}

/// 0 where the file does not have it.
std::uint16_t port(JsonFields config, const std::string& field) {
  double number = 0.0;
  config.optional(field, number);
  return number >= 0.0 && number <= 65535.0 ? static_cast<std::uint16_t>(number) : 0;
}

/// The rotation of a 4 x 4 transform, row-major; `usual` where the file does not have it.
Eigen::Matrix3d rotation(JsonFields fields, const std::string& field,
                         const Eigen::Matrix3d& usual) {
  if (!fields.has(field)) return usual;
  const std::vector<double> t = fields.numbers(field);
  if (t.size() != 16) fields.complain(field, "16 numbers");
  Eigen::Matrix3d result;
  result << t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10];
  const Eigen::Matrix3d product = result * result.transpose();
  if (!product.isIdentity(1e-3) || result.determinant() < 0.0) {
    fields.complain(field, "a rotation and a translation");
  }
  return result;
}

/// Our frame is Ouster's lidar frame, turned to look forward as its sensor frame usually does.
Eigen::Matrix3d rotation_of_imu(JsonFields& fields) {
  const Eigen::Matrix3d turned = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  const Eigen::Matrix3d R_base_lidar =
      rotation(fields.section("lidar_intrinsics"), "lidar_to_sensor_transform", turned);
  const Eigen::Matrix3d R_base_imu = rotation(
      fields.section("imu_intrinsics"), "imu_to_sensor_transform", Eigen::Matrix3d::Identity());
  return turned * R_base_lidar.transpose() * R_base_imu;
}

std::uint64_t whole_number(const std::string& text) {
  std::uint64_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() ? value : 0;
}

}  // namespace

std::string_view name(OusterProfile profile) { return facts(profile).name; }

const OusterLayout& layout(OusterProfile profile) { return facts(profile).layout; }

std::uint32_t frame_id(Bytes packet, OusterProfile profile) {
  switch (profile) {
    case OusterProfile::kLegacy:  // in each column; all of a packet are of one turn
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
  const std::size_t column = of.column_header + of.column_footer + of.pixel * pixels_per_column;
  return of.packet_header + of.packet_footer +
         column * static_cast<std::size_t>(columns_per_packet);
}

bool OusterMetadata::dual_return() const { return layout(profile).second_range_at > 0; }

bool is_ouster_metadata(const std::string& text) {
  try {
    const auto json = parsed_json(text, "");
    // What no other sensor's description has.
    return json.is_object() &&
           (json.contains("beam_altitude_angles") || json.contains("beam_intrinsics"));
  } catch (const Error&) {
    return false;
  }
}

OusterMetadata ouster_metadata_from_json(const std::string& text, const std::string& source) {
  OusterMetadata metadata;
  metadata.sensor = sensor_from_json(text, source);
  if (!is_ouster_metadata(text)) {
    throw Error(
        "{}: expected an Ouster's metadata, found the description of another sensor; give the "
        ".json file that the sensor wrote",
        source);
  }
  JsonFields fields(text, source, "give the metadata that the sensor wrote for this recording");
  JsonFields format =
      fields.section(fields.has("lidar_data_format") ? "lidar_data_format" : "data_format");
  JsonFields info = fields.section("sensor_info");
  metadata.profile = profile_of(format);
  format.optional("columns_per_packet", metadata.columns_per_packet);
  if (metadata.columns_per_packet < 1 || metadata.columns_per_packet > 64) {
    format.complain("columns_per_packet", "1 to 64");
  }
  JsonFields intrinsics = fields.section("beam_intrinsics");
  const OusterBeams beams = ouster_beams(intrinsics);
  metadata.pixels_per_column = beams.altitude_deg.size();
  metadata.pixel_of_row = beams.present;
  set_window(metadata, format);
  const std::string product = words(info, "prod_line").substr(0, 60);
  metadata.serial_number = whole_number(words(info, "prod_sn"));
  metadata.beam_origin_m = 1e-3 * beam_origin_mm(fields.section("beam_intrinsics"), product);
  metadata.lidar_port = port(fields.section("config_params"), "udp_port_lidar");
  metadata.imu_port = port(fields.section("config_params"), "udp_port_imu");
  const std::string imu_profile = words(format, "udp_profile_imu");
  if (!imu_profile.empty()) metadata.imu_profile = imu_profile.substr(0, 60);
  metadata.R_sensor_imu = rotation_of_imu(fields);
  for (double& offset_rad : metadata.sensor.beam_azimuth_offset_rad) {
    offset_rad += metadata.sensor.column_step_rad() / 2.0;
  }
  return metadata;
}

std::string ouster_metadata_text(const std::string& path) {
  return whole_file(path, "an Ouster's metadata (.json)", kMaxFileBytes);
}

OusterMetadata read_ouster_metadata(const std::string& path) {
  return ouster_metadata_from_json(ouster_metadata_text(path), path);
}

}  // namespace hqslam::recordings
