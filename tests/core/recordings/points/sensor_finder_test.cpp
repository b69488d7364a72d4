#include "points/sensor_finder.h"

#include "core/real_data.h"
#include "hqslam/core/angles.h"
#include "testing.h"

using namespace hqslam::recordings;

namespace {

enum class RowsFrom { kRings, kOrder, kNothing };

/// A scan in a round room of uneven walls, its floor 1.7 m below; lasers sit `up_m` above the
/// sensor's origin. kNothing: column after column.
RawPoints a_scan(const SensorModel& sensor, RowsFrom rows_from, double shift_m = 0.0,
                 double up_m = 0.0) {
  RawPoints raw{Scan{}};
  const auto add = [&](int row, int column) {
    if ((row + column / 100) % 7 == 3) return;  // nothing comes back
    const double wall_m = 12.0 + shift_m + 4.0 * std::cos(12.57 * column / sensor.columns);
    const double slope = -std::tan(sensor.beam_elevation_rad[row]);
    const double level_m = std::min(wall_m, slope > 0.0 ? (1.7 + up_m) / slope : 1e3);
    const double azimuth_rad = sensor.azimuth_rad(row, column);
    raw.scan.points_m.emplace_back(level_m * std::cos(azimuth_rad), level_m * std::sin(azimuth_rad),
                                   up_m - slope * level_m);
    if (rows_from == RowsFrom::kRings) raw.ring.push_back(sensor.rows() - 1 - row);
  };
  const int outer = rows_from == RowsFrom::kOrder ? sensor.rows() : sensor.columns;
  const int inner = rows_from == RowsFrom::kOrder ? sensor.columns : sensor.rows();
  for (int i = 0; i < outer; ++i) {
    for (int j = 0; j < inner; ++j) rows_from == RowsFrom::kOrder ? add(i, j) : add(j, i);
  }
  return raw;
}

std::vector<RawPoints> scans_of(const SensorModel& sensor, RowsFrom rows_from, double up_m = 0.0) {
  std::vector<RawPoints> scans;
  for (const double shift_m : {0.0, 1.0, 7.0})
    scans.push_back(a_scan(sensor, rows_from, shift_m, up_m));
  return scans;
}

double largest_difference_deg(const std::vector<double>& found_rad,
                              const std::vector<double>& table_rad) {
  REQUIRE(found_rad.size() == table_rad.size());
  double most = 0.0;
  for (std::size_t i = 0; i < table_rad.size(); ++i) {
    most = std::max(most, kDegreesPerRadian * std::abs(found_rad[i] - table_rad[i]));
  }
  return most;
}

bool is_refused_with(const std::vector<RawPoints>& scans, const std::string& part) {
  const std::string message = error_message([&] { find_sensor(scans, std::nullopt, "drive"); });
  INFO(message);
  CHECK(message.find("--sensor") != std::string::npos);
  return message.find(part) != std::string::npos;
}

/// Of a folder of files, or of one.
FoundSensor found_in(const std::string& path) {
  std::vector<std::string> paths = {path};
  if (std::filesystem::is_directory(path)) {
    paths.clear();
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      paths.push_back(entry.path().string());
    }
    std::ranges::sort(paths);
  }
  FoundSensor found = find_sensor_of_files(paths, {});
  MESSAGE(path, ": ", found.note);
  return found;
}

}  // namespace

TEST_CASE("the beams of every preset are found by rings, by the order of points, by elevation") {
  for (const std::string& name : sensor_preset_names()) {
    for (const RowsFrom rows_from : {RowsFrom::kRings, RowsFrom::kOrder, RowsFrom::kNothing}) {
      CAPTURE(name);
      CAPTURE(static_cast<int>(rows_from));
      const SensorModel sensor = sensor_preset(name);
      const FoundSensor found = find_sensor(scans_of(sensor, rows_from), std::nullopt, "drive");
      CHECK(found.sensor == sensor);
      CHECK(largest_difference_deg(found.beam_elevation_rad, sensor.beam_elevation_rad) < 0.001);
    }
  }
}

TEST_CASE("a sensor that is no preset is found with its columns and its rate") {
  SensorModel sensor = sensor_preset("vlp-16");
  sensor.columns = 2000;
  for (double& angle_rad : sensor.beam_elevation_rad) angle_rad *= 1.3;
  const SensorModel found = find_sensor(scans_of(sensor, RowsFrom::kNothing), 0.05, "drive").sensor;
  CHECK(found.name == "found-16");
  CHECK(found.columns == 2000);
  CHECK(found.scan_period_s == 0.05);
  CHECK(largest_difference_deg(found.beam_elevation_rad, sensor.beam_elevation_rad) < 0.001);
}

TEST_CASE("lasers above the origin are found with the elevation at which they meet the ground") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const FoundSensor found =
      find_sensor(scans_of(sensor, RowsFrom::kOrder, 0.2), std::nullopt, "drive");
  for (int row = 0; row < sensor.rows(); ++row) {
    const double slope = std::tan(sensor.beam_elevation_rad[row]);
    const double level_m = slope < 0.0 ? std::min(26.0, 1.9 / -slope) : 26.0;
    const double seen_rad = std::atan(slope + 0.2 / level_m);
    CHECK(kDegreesPerRadian * std::abs(found.beam_elevation_rad[row] - seen_rad) < 0.1);
  }
}

TEST_CASE("beams of which nothing came back are those of the preset that has the others") {
  std::vector<RawPoints> scans = scans_of(sensor_preset("vlp-16"), RowsFrom::kRings);
  for (RawPoints& raw : scans) {
    RawPoints seen{Scan{}};
    for (std::size_t i = 0; i < raw.ring.size(); ++i) {
      if (raw.ring[i] < 2.0) continue;
      seen.scan.points_m.push_back(raw.scan.points_m[i]);
      seen.ring.push_back(raw.ring[i]);
    }
    raw = seen;
  }
  CHECK(find_sensor(scans, std::nullopt, "drive").sensor.name == "vlp-16");
  for (RawPoints& raw : scans) {  // no preset
    for (Eigen::Vector3f& point_m : raw.scan.points_m) point_m.z() *= 1.3F;
  }
  CHECK(is_refused_with(scans, "14 of 16 rings"));
}

TEST_CASE("points that do not tell the beams are refused") {
  CHECK(is_refused_with({}, "no points"));
  CHECK(is_refused_with({RawPoints{Scan{}}}, "0 beams"));

  RawPoints cloud{Scan{}};  // of no sensor
  std::mt19937 random(7);
  for (int i = 0; i < 100'000; ++i) {
    const auto number = [&] { return static_cast<float>(random() % 10'000) / 500.0F; };
    cloud.scan.points_m.emplace_back(number() - 10.0F, number() - 10.0F, 0.3F * number() - 2.0F);
  }
  CHECK(is_refused_with({cloud}, "found "));

  RawPoints rings = a_scan(sensor_preset("vlp-16"), RowsFrom::kRings);
  for (std::size_t i = 0; i < rings.ring.size(); ++i) rings.ring[i] = static_cast<double>(i % 16);
  for (Eigen::Vector3f& point_m : rings.scan.points_m) {  // and shaken
    point_m.z() += 0.1F * static_cast<float>(random() % 100);
  }
  CHECK(is_refused_with({rings}, "between them"));
}

TEST_CASE("scans of two sensors are refused") {
  SensorModel other = sensor_preset("vlp-16");
  for (double& angle_rad : other.beam_elevation_rad) angle_rad += 0.01;
  for (const RowsFrom rows_from : {RowsFrom::kRings, RowsFrom::kOrder, RowsFrom::kNothing}) {
    CAPTURE(static_cast<int>(rows_from));
    CHECK(is_refused_with({a_scan(sensor_preset("vlp-16"), rows_from), a_scan(other, rows_from)},
                          "single scans"));
  }
}

TEST_CASE("rings that are no numbers of rings are passed over") {
  std::vector<RawPoints> scans = scans_of(sensor_preset("vlp-16"), RowsFrom::kRings);
  for (const double wrong : {std::nan(""), -1.0, 0.5, 1e30}) {
    scans[1].ring[5] = wrong;
    CHECK(find_sensor(scans, std::nullopt, "drive").sensor.name == "vlp-16");
  }
}

TEST_CASE("the beams of KITTI's HDL-64E are found within 0.1 degrees of its table") {
  const auto table = real_data("hdl64e_singles/beam_elevation_deg.npy");
  if (!table) return;
  for (const char* drive : {"kitti_drive_0005/velodyne", "kitti_drive_22/velodyne"}) {
    const FoundSensor found = found_in(*real_data(drive));
    CHECK(found.sensor.name == "hdl-64e");
    // The preset is that table, rounded to 0.001 degrees.
    const SensorModel preset = sensor_preset("hdl-64e");
    CHECK(largest_difference_deg(found.beam_elevation_rad, preset.beam_elevation_rad) < 0.1);
    CHECK_FALSE(with_own_beams(preset, found.beam_elevation_rad));  // whatever its lasers' parallax
  }
}

TEST_CASE("the beams of other real sensors are found in their clouds") {
  const auto drive = real_data("vlp16_drive/pcd");
  if (!drive) return;
  CHECK(found_in(*drive).sensor.name == "vlp-16");
  CHECK(found_in(*real_data("packets/velodyne/vlp-32c_1713492677464078412.pcd")).sensor.name ==
        "vlp-32c");
}

TEST_CASE("beams that a fast motion's correction blurs are found as they are or not at all") {
  for (const char* name : {"vlp-16", "os1-64", "hdl-32e"}) {
    CAPTURE(name);
    const SensorModel sensor = sensor_preset(name);
    for (const double step_m : {0.1, 0.2, 0.5, 1.0, 2.0}) {
      std::vector<RawPoints> scans = scans_of(sensor, RowsFrom::kNothing);
      for (RawPoints& raw : scans) {
        for (Eigen::Vector3f& point_m : raw.scan.points_m) {
          const double turned = std::atan2(point_m.y(), point_m.x()) * kDegreesPerRadian / 360.0;
          point_m.x() += static_cast<float>(step_m * turned);
        }
      }
      SensorModel found = sensor;
      const std::string refusal =
          error_message([&] { found = find_sensor(scans, std::nullopt, "drive").sensor; });
      CHECK(found == sensor);
      if (step_m < 0.15) CHECK(refusal == "no Error");
      if (step_m > 1.5) CHECK(refusal.find("between them") != std::string::npos);
    }
  }
}
