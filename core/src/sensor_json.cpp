#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/json_limits.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/core/whole_file.h"

namespace hqslam {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFileBytes = 16U << 20U;
constexpr std::array<std::string_view, 9> kFields = {"name",
                                                     "columns",
                                                     "scan_period_s",
                                                     "min_range_m",
                                                     "max_range_m",
                                                     "beam_elevation_deg",
                                                     "beam_azimuth_offset_deg",
                                                     "measured_rows",
                                                     "motion_corrected"};

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Rounded to a nano-degree: 16.61 rather than 16.609999999999999, and the same radians again.
double degrees(double radians) {
  return std::round(radians * 180.0 / std::numbers::pi * 1e9) / 1e9;
}

std::string text_of(const Json& value) {
  return excerpt(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

/// A JSON object read field by field; every complaint names file, field, expected and found.
class Fields {
 public:
  Fields(const Json& object, const std::string& path) : object_(object), path_(path) {}

  const Json& get(const std::string& field, const std::string& expected) const {
    if (!object_.contains(field)) complain(field, expected, "nothing");
    return object_[field];
  }

  std::string text(const std::string& field) const {
    const Json& value = get(field, "a text");
    if (!value.is_string()) complain(field, "a text", text_of(value));
    return value.get<std::string>();
  }

  double number(const std::string& field) const { return number(get(field, "a number"), field); }

  int integer(const std::string& field) const {
    const double value = number(field);
    if (value != std::floor(value) || std::abs(value) > 1e6) {
      complain(field, "a whole number of at most a million", text_of(object_[field]));
    }
    return static_cast<int>(value);
  }

  std::vector<double> angles_rad(const std::string& field) const {
    const std::string expected = "a list of angles in degrees";
    const Json& list = get(field, expected);
    if (!list.is_array()) complain(field, expected, text_of(list));
    std::vector<double> result;
    for (const Json& value : list) {
      result.push_back(radians(number(value, fmt::format("{}[{}]", field, result.size()))));
    }
    return result;
  }

  RowSelection row_selection(const std::string& field) const {
    const std::string expected = "an object of offset and stride";
    const Json& value = get(field, expected);
    if (!value.is_object() || value.size() != 2) complain(field, expected, text_of(value));
    const Fields fields(value, path_);
    return {fields.integer("offset"), fields.integer("stride")};
  }

  bool truth(const std::string& field) const {
    const Json& value = get(field, "true or false");
    if (!value.is_boolean()) complain(field, "true or false", text_of(value));
    return value.get<bool>();
  }

  [[noreturn]] void complain(const std::string& field, const std::string& expected,
                             const std::string& found) const {
    throw Error(fmt::format("{}: field '{}': expected {}, found {}; correct the sensor file", path_,
                            field, expected, found));
  }

 private:
  double number(const Json& value, const std::string& field) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      complain(field, "a finite number", text_of(value));
    }
    return value.get<double>();
  }

  const Json& object_;
  const std::string& path_;
};

SensorModel sensor_from_own_form(const Json& json, const std::string& path) {
  const Fields fields(json, path);
  for (const auto& item : json.items()) {
    if (std::find(kFields.begin(), kFields.end(), item.key()) == kFields.end()) {
      fields.complain(excerpt(item.key()), fmt::format("one of {}", fmt::join(kFields, ", ")),
                      "an unknown field");
    }
  }
  SensorModel sensor;
  sensor.name = fields.text("name");
  sensor.columns = fields.integer("columns");
  sensor.scan_period_s = fields.number("scan_period_s");
  sensor.min_range_m = fields.number("min_range_m");
  sensor.max_range_m = fields.number("max_range_m");
  sensor.beam_elevation_rad = fields.angles_rad("beam_elevation_deg");
  sensor.beam_azimuth_offset_rad = fields.angles_rad("beam_azimuth_offset_deg");
  if (json.contains("measured_rows")) sensor.measured_rows = fields.row_selection("measured_rows");
  if (json.contains("motion_corrected")) sensor.motion_corrected = fields.truth("motion_corrected");
  return sensor;
}

/// The object of this name, or the whole file: newer firmware groups what older kept flat.
const Json& section(const Json& json, const char* name) {
  return json.contains(name) && json[name].is_object() ? json[name] : json;
}

/// "1024x10": columns per scan and scans per second.
void set_lidar_mode(SensorModel& sensor, const Fields& fields) {
  const std::string mode = fields.text("lidar_mode");
  int columns = 0;
  int scans_per_s = 0;
  const char* const end = mode.data() + mode.size();
  const auto first = std::from_chars(mode.data(), end, columns);
  bool parsed = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  if (parsed) {
    const auto second = std::from_chars(first.ptr + 1, end, scans_per_s);
    parsed = second.ec == std::errc() && second.ptr == end && columns > 0 && scans_per_s > 0;
  }
  if (!parsed) {
    fields.complain("lidar_mode", "COLUMNSxSCANS_PER_SECOND such as 1024x10",
                    fmt::format("'{}'", excerpt(mode)));
  }
  sensor.columns = columns;
  sensor.scan_period_s = 1.0 / scans_per_s;
}

/// Ouster's metadata. Its azimuth angles are clockwise-positive; ours are counter-clockwise. Its
/// first column, like ours, looks backwards in the sensor frame.
/// Source: Ouster sensor documentation, "Sensor metadata" and "Lidar coordinate frame".
SensorModel sensor_from_ouster(const Json& json, const std::string& path) {
  const Fields beams(section(json, "beam_intrinsics"), path);
  SensorModel sensor;
  sensor.beam_elevation_rad = beams.angles_rad("beam_altitude_angles");
  sensor.beam_azimuth_offset_rad = beams.angles_rad("beam_azimuth_angles");
  for (double& offset_rad : sensor.beam_azimuth_offset_rad) offset_rad = -offset_rad;

  const char* const format_name =
      json.contains("lidar_data_format") ? "lidar_data_format" : "data_format";
  const Json& format = section(json, format_name);
  const Json& config = section(json, "config_params");
  const Fields format_fields(format, path);
  if (config.contains("lidar_mode") || !format.contains("fps")) {
    set_lidar_mode(sensor, Fields(config, path));
  } else {
    sensor.columns = format_fields.integer("columns_per_frame");
    const double scans_per_s = format_fields.number("fps");
    if (!(scans_per_s > 0.0)) {
      format_fields.complain("fps", "a positive number", text_of(format["fps"]));
    }
    sensor.scan_period_s = 1.0 / scans_per_s;
  }
  if (format.contains("columns_per_frame")) {
    const int columns = format_fields.integer("columns_per_frame");
    if (columns != sensor.columns) {
      format_fields.complain("columns_per_frame",
                             fmt::format("{} as in lidar_mode", sensor.columns),
                             fmt::format("{}", columns));
    }
  }
  const Json& info = section(json, "sensor_info");
  sensor.name = info.contains("prod_line") ? Fields(info, path).text("prod_line")
                                           : std::filesystem::path(path).stem().string();
  return sensor;
}

void require_printable_name(const SensorModel& sensor, const std::string& path) {
  constexpr std::size_t kMaxCharacters = 100;
  const bool fits = !sensor.name.empty() && sensor.name.size() <= kMaxCharacters &&
                    std::all_of(sensor.name.begin(), sensor.name.end(),
                                [](unsigned char c) { return std::isprint(c) != 0; });
  if (!fits) {
    throw Error(
        fmt::format("{}: field 'name': expected 1 to {} printable ASCII characters, found "
                    "'{}'; correct the sensor file",
                    path, kMaxCharacters, excerpt(sensor.name)));
  }
}

Json parsed(const std::string& bytes, const std::string& path) {
  check_json_limits(bytes, path);
  Json json;
  try {
    json = Json::parse(bytes);
  } catch (const Json::parse_error& error) {
    throw Error(fmt::format("{}: expected JSON, found something else at byte {}; correct the file",
                            path, error.byte));
  } catch (const Json::exception&) {
    throw Error(
        fmt::format("{}: expected JSON with finite numbers, found a number out of range; "
                    "correct the file",
                    path));
  }
  if (!json.is_object()) {
    throw Error(
        fmt::format("{}: expected a JSON object with the fields of a sensor, found {}; "
                    "correct the file",
                    path, text_of(json)));
  }
  return json;
}

}  // namespace

SensorModel sensor_from_json(const std::string& text, const std::string& source) {
  const Json json = parsed(text, source);
  const bool ouster = json.contains("beam_altitude_angles") || json.contains("beam_intrinsics");
  const SensorModel sensor =
      ouster ? sensor_from_ouster(json, source) : sensor_from_own_form(json, source);
  require_printable_name(sensor, source);
  try {
    validate(sensor);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}; correct the sensor file", source, error.what()));
  }
  return sensor;
}

SensorModel read_sensor_json(const std::string& path) {
  return sensor_from_json(whole_file(path, "a sensor's .json file", kMaxFileBytes), path);
}

std::string sensor_json(const SensorModel& sensor) {
  Json json;
  json["name"] = sensor.name;
  json["columns"] = sensor.columns;
  json["scan_period_s"] = sensor.scan_period_s;
  json["min_range_m"] = sensor.min_range_m;
  json["max_range_m"] = sensor.max_range_m;
  for (const double angle_rad : sensor.beam_elevation_rad) {
    json["beam_elevation_deg"].push_back(degrees(angle_rad));
  }
  for (const double angle_rad : sensor.beam_azimuth_offset_rad) {
    json["beam_azimuth_offset_deg"].push_back(degrees(angle_rad));
  }
  if (sensor.measured_rows) {
    json["measured_rows"] = {{"offset", sensor.measured_rows->offset},
                             {"stride", sensor.measured_rows->stride}};
  }
  if (sensor.motion_corrected) json["motion_corrected"] = true;
  return json.dump(1) + "\n";
}

void write_sensor_json(const SensorModel& sensor, const std::string& path) {
  write_whole_file(path, sensor_json(sensor));
}

SensorModel load_sensor(const std::string& preset_or_path) {
  const bool is_path =
      preset_or_path.ends_with(".json") || preset_or_path.find('/') != std::string::npos;
  return is_path ? read_sensor_json(preset_or_path) : sensor_preset(preset_or_path);
}

}  // namespace hqslam
