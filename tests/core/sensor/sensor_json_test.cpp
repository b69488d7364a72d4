#include "hqslam/core/angles.h"
#include "hqslam/core/sensor_model.h"
#include "testing.h"

namespace {

constexpr const char* kOwn = R"({"name": "two", "columns": 1024, "scan_period_s": 0.1,
  "min_range_m": 0.5, "max_range_m": 80, "beam_elevation_deg": [10, -10],
  "beam_azimuth_offset_deg": [1.5, 0]})";

constexpr const char* kGrouped = R"({"sensor_info": {"prod_line": "OS-0-32"},
  "beam_intrinsics": {"beam_altitude_angles": [10, -10], "beam_azimuth_angles": [3, -3]},
  "lidar_data_format": {"columns_per_frame": 512}, "config_params": {"lidar_mode": "512x20"}})";

SensorModel sensor_of(const std::string& json) {
  return from_file("s.json", json, read_sensor_json);
}

void refuses_json(const std::string& json, const auto&... parts) {
  CHECK(refused_with([&] { sensor_of(json); }, parts...));
}

}  // namespace

TEST_CASE("a sensor file in degrees is read field by field") {
  const SensorModel sensor = sensor_of(kOwn);
  CHECK(sensor.name == "two");
  CHECK(sensor.columns == 1024);
  CHECK(sensor.scan_period_s == 0.1);
  CHECK(sensor.min_range_m == 0.5);
  CHECK(sensor.max_range_m == 80.0);
  REQUIRE(sensor.rows() == 2);
  CHECK(degrees(sensor.beam_elevation_rad[0]) == doctest::Approx(10.0));
  CHECK(degrees(sensor.beam_azimuth_offset_rad[0]) == doctest::Approx(1.5));
}

TEST_CASE("measured rows and a correction for motion come back from a sensor file") {
  CHECK(!sensor_of(kOwn).measured_rows);
  CHECK_FALSE(sensor_of(kOwn).motion_corrected);
  const SensorModel sensor = sensor_of(replaced_in(kOwn, "\"columns\"",
                                                   R"("measured_rows": {"offset": 1, "stride": 4},
                                                      "motion_corrected": true, "columns")"));
  CHECK(sensor.measured_rows == RowSelection{1, 4});
  CHECK(sensor.motion_corrected);
  CHECK(sensor_of(sensor_json(sensor)) == sensor);
}

TEST_CASE("every preset comes back from its file to a hundred-millionth of a degree") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("s.json");
  for (const std::string& name : sensor_preset_names()) {
    CAPTURE(name);
    const SensorModel sensor = sensor_preset(name);
    write_sensor_json(sensor, path);
    const SensorModel back = load_sensor(path);
    CHECK(back.name == sensor.name);
    CHECK(back.columns == sensor.columns);
    CHECK(back.scan_period_s == sensor.scan_period_s);
    CHECK(back.min_range_m == sensor.min_range_m);
    CHECK(back.max_range_m == sensor.max_range_m);
    REQUIRE(back.rows() == sensor.rows());
    for (int row = 0; row < sensor.rows(); ++row) {
      CHECK(std::abs(degrees(back.beam_elevation_rad[row] - sensor.beam_elevation_rad[row])) <
            1e-8);
      CHECK(std::abs(degrees(back.beam_azimuth_offset_rad[row] -
                             sensor.beam_azimuth_offset_rad[row])) < 1e-8);
    }
    write_sensor_json(back, directory.file("again.json"));
    CHECK(file_contents(path) == file_contents(directory.file("again.json")));
  }
}

TEST_CASE("Ouster's grouped metadata give the sensor with azimuths turned counter-clockwise") {
  const SensorModel sensor = sensor_of(kGrouped);
  CHECK(sensor.name == "OS-0-32");
  CHECK(sensor.columns == 512);
  CHECK(sensor.scan_period_s == 0.05);
  CHECK(degrees(sensor.beam_elevation_rad[1]) == doctest::Approx(-10.0));
  CHECK(degrees(sensor.beam_azimuth_offset_rad[0]) == doctest::Approx(-3.0));
  const SensorModel without_mode = sensor_of(replaced_in(
      replaced_in(kGrouped, R"("lidar_mode": "512x20")", ""), R"(512})", R"(512, "fps": 10})"));
  CHECK(without_mode.columns == 512);
  CHECK(without_mode.scan_period_s == 0.1);
}

TEST_CASE("a sensor file with a wrong field is refused with file, field, expected and found") {
  const auto refuses = [](const std::string& from, const std::string& to, const auto&... parts) {
    CAPTURE(to);
    refuses_json(replaced_in(kOwn, from, to), parts...);
  };
  refuses("\"max_range_m\": 80,", "", "s.json", "'max_range_m'", "expected a number",
          "found nothing");
  refuses("\"max_range_m\"", "\"max_range\"", "'max_range_m'", "found nothing");
  refuses("\"columns\"", "\"max_range\": 80, \"columns\"", "s.json", "unknown field 'max_range'");
  refuses("1024", "\"many\"", "'columns'", "number", "\"many\"");
  refuses("1024", "1024.5", "'columns'", "whole number", "1024.5");
  refuses("1024", "1000001", "'columns'", "at most a million", "1000001");
  refuses("[10, -10]", "[10, null]", "'beam_elevation_deg[1]'", "null");
  refuses("[10, -10]", "10", "'beam_elevation_deg'", "list", "found 10");
  const auto refuses_measured_rows = [&](const std::string& value, const auto&... parts) {
    refuses("\"columns\"", "\"measured_rows\": " + value + ", \"columns\"", parts...);
  };
  refuses_measured_rows("3", "'measured_rows'", "offset and stride", "found 3");
  refuses_measured_rows("{\"offset\": 1, \"step\": 4}", "'stride'", "nothing");
  refuses_measured_rows("{\"offset\": 2, \"stride\": 4}", "measured_rows", "offset of 0 to 1");
  refuses("\"columns\"", "\"motion_corrected\": 1, \"columns\"", "'motion_corrected'",
          "true or false", "found 1");
  refuses("\"two\"", "2", "'name'", "text", "found 2");
  refuses("\"two\"", "\"a\\nb\"", "'name'", "printable");
  refuses("80", "1e999", "s.json", "out of range");
  refuses("80", "NaN", "s.json", "expected JSON");
  refuses("[10, -10]", "[-10, 10]", "s.json", "elevations must fall");
  refuses("[1.5, 0]", "[1.5]", "s.json", "azimuth offsets");
  refuses_json("[1, 2]", "s.json", "object");
  refuses_json("{\"name\": \"x\"", "s.json", "JSON", "byte");
  refuses_json(std::string(100000, '['), "s.json", "JSON");
}

TEST_CASE("values nested deeper than 32 levels and objects of more than 1000 fields are refused") {
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  refuses_json(deep, "s.json", "at most 32 levels");
  refuses_json(replaced_in(kOwn, "1024", deep), "s.json", "at most 32 levels");
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  refuses_json(objects + "1" + std::string(100'000, '}'), "32 levels");
  std::string fields;
  for (int i = 0; i < 300'000; ++i) fields += ", \"" + std::to_string(i) + "\": 0";
  refuses_json(replaced_in(kOwn, "80", "80" + fields), "s.json", "at most 1000 fields");
  std::string text =
      "{\"lidar_mode\": \"512x20\", \"beam_altitude_angles\": [1], "
      "\"beam_azimuth_angles\": [0], \"deep\": " +
      std::string(31, '[') + std::string(31, ']');
  for (int i = 4; i < 1000; ++i) text += ", \"" + std::to_string(i) + "\": 0";
  CHECK(sensor_of(text + "}").columns == 512);
  refuses_json(text + ", \"more\": 0}", "at most 1000 fields");
}

TEST_CASE("Ouster metadata that contradict themselves or lack a field are refused") {
  const auto refuses = [](const std::string& from, const std::string& to, const auto&... parts) {
    CAPTURE(to);
    refuses_json(replaced_in(kGrouped, from, to), parts...);
  };
  refuses("512x20", "fast", "s.json", "'lidar_mode'", "1024x10", "\"fast\"");
  refuses("512x20", "1024x10", "'columns_per_frame'", "1024", "found 512");
  refuses("\"lidar_mode\": \"512x20\"", "", "'lidar_mode'", "found nothing");
  refuses("beam_azimuth_angles", "other", "'beam_azimuth_angles'", "nothing");
}

TEST_CASE("a sensor is loaded by the name of a preset or the path of a file") {
  CHECK(load_sensor("vlp-16") == sensor_preset("vlp-16"));
  CHECK(refused_with([] { load_sensor("/nowhere/x.json"); }, "/nowhere/x.json", "no file"));
  CHECK(refused_with([] { load_sensor("os9"); }, "os9", "os1-64"));
  CHECK(refused_with([] { load_sensor("/tmp/"); }, "/tmp/", "folder"));
}
