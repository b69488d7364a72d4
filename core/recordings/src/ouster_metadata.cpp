#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hqslam/core/error.h"
#include "hqslam/core/json_limits.h"
#include "hqslam/core/whole_file.h"
#include "ouster_layout.h"
#include "ouster_metadata_text.h"

namespace hqslam::recordings {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxFileBytes = 16U << 20U;
constexpr std::array<OusterProfile, 5> kProfiles = {
    OusterProfile::kLegacy, OusterProfile::kRng19, OusterProfile::kRng19Dual, OusterProfile::kRng15,
    OusterProfile::kFusaDual};

/// The object of this name, or the whole file: newer firmware groups what older kept flat.
const Json& section(const Json& json, const char* name) {
  return json.contains(name) && json[name].is_object() ? json[name] : json;
}

[[noreturn]] void complain(const std::string& source, const char* field,
                           const std::string& expected, const std::string& found) {
  throw Error(
      fmt::format("{}: field '{}': expected {}, found {}; give the metadata that the sensor "
                  "wrote for this recording",
                  source, field, expected, found));
}

double number(const Json& json, const char* field, double otherwise, const std::string& source) {
  if (!json.contains(field)) return otherwise;
  const Json& value = json[field];
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    complain(source, field, "a finite number", "something else");
  }
  return value.get<double>();
}

std::string words(const Json& json, const char* field) {
  return json.contains(field) && json[field].is_string() ? json[field].get<std::string>() : "";
}

OusterProfile profile_of(const Json& format, const std::string& source) {
  const std::string found = words(format, "udp_profile_lidar");
  if (found.empty()) return OusterProfile::kLegacy;  // firmware before there were profiles
  std::string known;
  for (const OusterProfile profile : kProfiles) {
    if (name(profile) == found) return profile;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", name(profile));
  }
  complain(source, "udp_profile_lidar", "one of " + known,
           found.size() < 60 ? "'" + found + "'" : "another one");
}

/// Where the file does not say: the value of the product line.
double usual_beam_origin_mm(const std::string& product) {
  if (product.starts_with("OS-0-")) return 27.67;
  if (product.starts_with("OS-1-")) return 15.806;
  if (product.starts_with("OS-2-")) return 13.762;
  return 12.163;  // the first generation, whose files name no product
}

double beam_origin_mm(const Json& json, const std::string& product, const std::string& source) {
  const Json& beams = section(json, "beam_intrinsics");
  constexpr const char* kTransform = "beam_to_lidar_transform";
  double result =
      number(beams, "lidar_origin_to_beam_origin_mm", usual_beam_origin_mm(product), source);
  if (beams.contains(kTransform)) {  // 4 x 4, row-major; the beams begin at its translation in x
    const Json& transform = beams[kTransform];
    if (!transform.is_array() || transform.size() != 16 || !transform[3].is_number()) {
      complain(source, kTransform, "16 numbers", "something else");
    }
    result = transform[3].get<double>();
  }
  if (!(result >= 0.0 && result < 1000.0)) {
    complain(source, "lidar_origin_to_beam_origin_mm", "0 to 1000", fmt::format("{}", result));
  }
  return result;
}

void set_window(OusterMetadata& metadata, const Json& format, const std::string& source) {
  metadata.first_column = 0;
  metadata.last_column = metadata.sensor.columns - 1;
  constexpr const char* kWindow = "column_window";
  if (!format.contains(kWindow)) return;
  const Json& window = format[kWindow];
  const auto is_column = [&](const Json& value) {
    return value.is_number_integer() && value.get<double>() >= 0.0 &&
           value.get<double>() < metadata.sensor.columns;
  };
  if (!window.is_array() || window.size() != 2 || !is_column(window[0]) || !is_column(window[1])) {
    complain(source, kWindow, fmt::format("two columns, 0 to {}", metadata.sensor.columns - 1),
             "something else");
  }
  metadata.first_column = window[0].get<int>();
  metadata.last_column = window[1].get<int>();
}

/// What no other sensor's description has.
bool has_beams_of_ouster(const Json& json) {
  return json.is_object() &&
         (json.contains("beam_altitude_angles") || json.contains("beam_intrinsics"));
}

std::uint64_t whole_number(const std::string& text) {
  std::uint64_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() ? value : 0;
}

}  // namespace

bool is_ouster_metadata(const std::string& text) {
  return has_beams_of_ouster(Json::parse(text, nullptr, /*allow_exceptions=*/false));
}

OusterMetadata ouster_metadata_from_json(const std::string& text, const std::string& source) {
  OusterMetadata metadata;
  metadata.sensor = sensor_from_json(text, source);
  const Json json = Json::parse(text);  // sensor_from_json has checked that it can be
  if (!has_beams_of_ouster(json)) {
    throw Error(
        fmt::format("{}: expected an Ouster's metadata, found the description of another "
                    "sensor; give the .json file that the sensor wrote",
                    source));
  }
  const Json& format =
      section(json, json.contains("lidar_data_format") ? "lidar_data_format" : "data_format");
  const Json& info = section(json, "sensor_info");
  const Json& config = section(json, "config_params");
  metadata.profile = profile_of(format, source);
  const double columns = number(format, "columns_per_packet", 16.0, source);
  if (!(columns >= 1.0 && columns <= 64.0) || columns != std::floor(columns)) {
    complain(source, "columns_per_packet", "1 to 64", fmt::format("{}", columns));
  }
  metadata.columns_per_packet = static_cast<int>(columns);
  set_window(metadata, format, source);
  metadata.product = words(info, "prod_line").substr(0, 60);
  metadata.serial_number = whole_number(words(info, "prod_sn"));
  metadata.beam_origin_m = 1e-3 * beam_origin_mm(json, metadata.product, source);
  const double port = number(config, "udp_port_lidar", 0.0, source);
  metadata.lidar_port = port >= 0.0 && port <= 65535.0 ? static_cast<std::uint16_t>(port) : 0;
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
