#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/ouster_beams.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxSensorFileBytes = 16U << 20U;

/// Rounded to a nano-degree: 16.61 rather than 16.609999999999999, and the same radians again.
double rounded_deg(double angle_rad) { return std::round(degrees(angle_rad) * 1e9) / 1e9; }

RowSelection row_selection(JsonFields& fields, const std::string& field) {
  if (!fields.is_object(field)) fields.complain(field, "an object of offset and stride");
  JsonFields rows = fields.object(field);
  const RowSelection selection{rows.small_integer("offset"), rows.small_integer("stride")};
  rows.finish();
  return selection;
}

SensorModel sensor_from_own_form(JsonFields fields) {
  SensorModel sensor;
  sensor.name = fields.text("name");
  sensor.columns = fields.small_integer("columns");
  sensor.scan_period_s = fields.number("scan_period_s");
  sensor.min_range_m = fields.number("min_range_m");
  sensor.max_range_m = fields.number("max_range_m");
  sensor.beam_elevation_rad = radians(fields.numbers("beam_elevation_deg"));
  sensor.beam_azimuth_offset_rad = radians(fields.numbers("beam_azimuth_offset_deg"));
  if (fields.has("elevation_correction_deg")) {
    sensor.elevation_correction_rad = radians(fields.numbers("elevation_correction_deg"));
    sensor.range_correction_m = fields.numbers("range_correction_m");
  }
  if (fields.has("measured_rows")) sensor.measured_rows = row_selection(fields, "measured_rows");
  fields.optional("motion_corrected", sensor.motion_corrected);
  fields.finish();
  return sensor;
}

/// "1024x10": columns per scan and scans per second.
void set_lidar_mode(SensorModel& sensor, JsonFields fields) {
  const std::string mode = fields.text("lidar_mode");
  const std::size_t x = std::min(mode.find('x'), mode.size());
  const auto columns = number_from<int>(std::string_view(mode).substr(0, x));
  const auto scans_per_s =
      number_from<int>(std::string_view(mode).substr(std::min(x + 1, mode.size())));
  if (!columns || !scans_per_s || *columns <= 0 || *scans_per_s <= 0) {
    fields.complain("lidar_mode", "COLUMNSxSCANS_PER_SECOND such as 1024x10");
  }
  sensor.columns = *columns;
  sensor.scan_period_s = 1.0 / *scans_per_s;
}

/// Ouster's metadata. Its azimuth angles are clockwise-positive; ours are counter-clockwise. Its
/// first column, like ours, looks backwards in the sensor frame.
/// Source: Ouster sensor documentation, "Sensor metadata" and "Lidar coordinate frame".
SensorModel sensor_from_ouster(JsonFields fields, const std::string& path) {
  JsonFields beams = fields.section("beam_intrinsics");
  SensorModel sensor;
  const OusterBeams listed = ouster_beams(beams);
  for (const std::size_t i : listed.present) {
    sensor.beam_elevation_rad.push_back(radians(listed.altitude_deg[i]));
    sensor.beam_azimuth_offset_rad.push_back(-radians(listed.azimuth_deg[i]));
  }

  JsonFields format =
      fields.section(fields.has("lidar_data_format") ? "lidar_data_format" : "data_format");
  JsonFields config = fields.section("config_params");
  if (config.has("lidar_mode") || !format.has("fps")) {
    set_lidar_mode(sensor, config);
  } else {
    sensor.columns = format.small_integer("columns_per_frame");
    const double scans_per_s = format.number("fps");
    if (!(scans_per_s > 0.0)) format.complain("fps", "a positive number");
    sensor.scan_period_s = 1.0 / scans_per_s;
  }
  if (format.has("columns_per_frame") &&
      format.small_integer("columns_per_frame") != sensor.columns) {
    format.complain("columns_per_frame", fmt::format("{} as in lidar_mode", sensor.columns));
  }
  JsonFields info = fields.section("sensor_info");
  sensor.name =
      info.has("prod_line") ? info.text("prod_line") : std::filesystem::path(path).stem().string();
  return sensor;
}

void require_printable_name(const SensorModel& sensor, const std::string& path) {
  constexpr std::size_t kMaxCharacters = 100;
  const bool fits =
      !sensor.name.empty() && sensor.name.size() <= kMaxCharacters &&
      std::ranges::all_of(sensor.name, [](unsigned char c) { return std::isprint(c) != 0; });
  if (!fits) {
    throw Error(
        "{}: field 'name': expected 1 to {} printable ASCII characters, found '{}'; correct the "
        "sensor file",
        path, kMaxCharacters, excerpt(sensor.name));
  }
}

}  // namespace

OusterBeams ouster_beams(JsonFields& fields) {
  constexpr const char* kAzimuth = "beam_azimuth_angles";
  OusterBeams beams{fields.numbers("beam_altitude_angles"), fields.numbers(kAzimuth), {}};
  const std::size_t listed = beams.altitude_deg.size();
  if (beams.azimuth_deg.size() != listed) {
    fields.complain(kAzimuth, fmt::format("{} angles, one for each altitude", listed));
  }
  std::vector<std::size_t> zeros;
  for (std::size_t i = 0; i < listed; ++i) {
    const bool is_zero = beams.altitude_deg[i] == 0.0 && beams.azimuth_deg[i] == 0.0;
    (is_zero ? zeros : beams.present).push_back(i);
  }
  if (zeros.size() == 1) {  // one beam may look there
    beams.present.push_back(zeros.front());
    std::ranges::sort(beams.present);
  }
  return beams;
}

SensorModel sensor_from_json(const std::string& text, const std::string& source) {
  const JsonFields fields(text, source, "correct the sensor file");
  const bool ouster = fields.has("beam_altitude_angles") || fields.has("beam_intrinsics");
  const SensorModel sensor =
      ouster ? sensor_from_ouster(fields, source) : sensor_from_own_form(fields);
  require_printable_name(sensor, source);
  try {
    validate(sensor);
  } catch (const Error& error) {
    throw Error("{}: {}; correct the sensor file", source, error.what());
  }
  return sensor;
}

SensorModel read_sensor_json(const std::string& path) {
  return sensor_from_json(whole_file(path, "a sensor's .json file", kMaxSensorFileBytes), path);
}

std::string sensor_json(const SensorModel& sensor) {
  Json json;
  json["name"] = sensor.name;
  json["columns"] = sensor.columns;
  json["scan_period_s"] = sensor.scan_period_s;
  json["min_range_m"] = sensor.min_range_m;
  json["max_range_m"] = sensor.max_range_m;
  const auto put_deg = [&](const char* name, const std::vector<double>& angles_rad) {
    for (const double angle_rad : angles_rad) json[name].push_back(rounded_deg(angle_rad));
  };
  put_deg("beam_elevation_deg", sensor.beam_elevation_rad);
  put_deg("beam_azimuth_offset_deg", sensor.beam_azimuth_offset_rad);
  put_deg("elevation_correction_deg", sensor.elevation_correction_rad);
  if (!sensor.range_correction_m.empty()) json["range_correction_m"] = sensor.range_correction_m;
  if (sensor.measured_rows) {
    json["measured_rows"] = {{"offset", sensor.measured_rows->offset},
                             {"stride", sensor.measured_rows->stride}};
  }
  if (sensor.motion_corrected) json["motion_corrected"] = true;
  return json.dump(1) + "\n";
}

void write_sensor_json(const SensorModel& sensor, const std::string& path) {
  replace_file(path, [&](const std::string& part) { write_whole_file(part, sensor_json(sensor)); });
}

SensorModel load_sensor(const std::string& preset_or_path) {
  const bool is_path =
      preset_or_path.ends_with(".json") || preset_or_path.find('/') != std::string::npos;
  return is_path ? read_sensor_json(preset_or_path) : sensor_preset(preset_or_path);
}

}  // namespace hqslam
