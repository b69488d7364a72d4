#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "velodyne_tables.h"

// db.xml is what boost::serialization writes of the corrections:
//   <points_> ... <item ...><px ...><id_>0</id_><rotCorrection_>-5.4</rotCorrection_> ... </px> ...
// angles in degrees, lengths in centimetres, the rotation clockwise and to be subtracted. Nothing
// but the elements of <px> is looked at.

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMaxBytes = 1U << 20U;
constexpr int kLasers = 64;
/// Rows must fall strictly; two lasers of one elevation are this far apart.
constexpr double kLeastStep_rad = 1e-7;

/// What <name>number</name> holds of a laser's element. Throws Error if that is not within +-most.
double number_in(std::string_view element, const char* name, double most, const std::string& path) {
  const std::string tag = fmt::format("<{}>", name);
  const std::size_t at = element.find(tag);
  double value = 0.0;
  bool sound = at != std::string_view::npos;
  if (sound) {
    std::string_view text = element.substr(at + tag.size());
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    sound = std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc();
  }
  if (!sound || !(std::abs(value) <= most)) {
    throw Error(
        "{}: field '{}': expected a number within +-{}, found {}; give the db.xml that came with "
        "the sensor",
        path, name, most, sound ? fmt::format("{}", value) : std::string("none"));
  }
  return value;
}

}  // namespace

VelodyneCalibration read_velodyne_calibration(const std::string& path) {
  const std::string contents = whole_file(path, "the db.xml of an HDL-64E", kMaxBytes);
  std::array<std::optional<VelodyneCalibration::Laser>, kLasers> found;
  int lasers = 0;
  for (std::size_t at = contents.find("<px"); at != std::string::npos;
       at = contents.find("<px", at + 1)) {
    const std::size_t end = contents.find("</px>", at);
    if (end == std::string::npos) break;
    const auto number = [&](const char* name, double most) {
      return number_in(std::string_view(contents).substr(at, end - at), name, most, path);
    };
    const double id = number("id_", 1000.0);
    if (!(id >= 0.0 && id < kLasers) || id != std::floor(id)) continue;  // of a unit with fewer
    VelodyneCalibration::Laser laser;
    laser.azimuth_offset_rad = kDegree_rad * number("rotCorrection_", 30.0);
    laser.elevation_rad = kDegree_rad * number("vertCorrection_", 60.0);
    laser.distance_m = 0.01 * number("distCorrection_", 1000.0);
    laser.up_m = 0.01 * number("vertOffsetCorrection_", 100.0);
    laser.left_m = 0.01 * number("horizOffsetCorrection_", 100.0);
    auto& of_id = found[static_cast<std::size_t>(id)];
    if (!of_id) ++lasers;
    of_id = laser;
  }
  if (lasers != kLasers) {
    throw Error(
        "{}: expected the corrections of {} lasers, found {}; give the db.xml that came with the "
        "HDL-64E",
        path, kLasers, lasers);
  }
  VelodyneCalibration calibration;
  for (const auto& laser : found) calibration.lasers.push_back(*laser);
  return calibration;
}

SensorModel sensor_of(const VelodyneCalibration& calibration) {
  SensorModel sensor = sensor_preset(name(VelodyneModel::kHdl64e));
  const std::vector<int> rows = laser_rows(calibration);
  sensor.beam_elevation_rad.resize(rows.size());
  sensor.beam_azimuth_offset_rad.resize(rows.size());
  for (std::size_t laser = 0; laser < rows.size(); ++laser) {
    sensor.beam_elevation_rad[rows[laser]] = calibration.lasers[laser].elevation_rad;
    sensor.beam_azimuth_offset_rad[rows[laser]] = calibration.lasers[laser].azimuth_offset_rad;
  }
  for (std::size_t row = 1; row < rows.size(); ++row) {
    double& own_rad = sensor.beam_elevation_rad[row];
    own_rad = std::min(own_rad, sensor.beam_elevation_rad[row - 1] - kLeastStep_rad);
  }
  validate(sensor);
  return sensor;
}

}  // namespace hqslam::recordings
