#include "hqslam/sim/write_drive.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hqslam/core/angles.h"
#include "hqslam/core/cloud_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/core/whole_file.h"

namespace hqslam::sim {

namespace {

namespace fs = std::filesystem;

void make_directory(const fs::path& directory) {
  std::error_code failure;
  fs::create_directories(directory, failure);
  if (!failure && fs::is_directory(directory)) return;
  throw Error(
      "{}: expected a folder that can be written, found none and cannot make it ({}); choose "
      "another",
      directory.string(), failure.message());
}

/// Makes a folder for files of scans. Files that an earlier, longer drive left in it would be read
/// as scans of this one.
void make_empty_directory(const fs::path& directory) {
  make_directory(directory);
  if (fs::is_empty(directory)) return;
  throw Error("{}: expected an empty folder, found files; remove them or choose another folder",
              directory.string());
}

std::string in(const std::string& directory, std::string_view name) {
  return (fs::path(directory) / name).string();
}

/// Writes the beam errors, which a calibration of the beams should find.
void write_sensor_errors_json(const std::string& path, const DriveSpec& spec, int rows) {
  BeamErrors beams = draw_beam_errors(spec.sensor_errors, rows, spec.seed);
  for (auto* angles : {&beams.elevation_rad, &beams.azimuth_rad}) {
    for (double& angle : *angles) angle /= kDegree_rad;
  }
  const nlohmann::ordered_json json = {{"sensor_errors", name_of(spec.sensor_errors)},
                                       {"range_m", beams.range_m},
                                       {"elevation_deg", beams.elevation_rad},
                                       {"azimuth_deg", beams.azimuth_rad},
                                       {"intensity_gain", beams.intensity_gain}};
  write_whole_file(path, json.dump(2) + "\n");
}

/// Makes `directory` with its drive.json and returns its path, with which members that open files
/// in it are initialised: drive.json is the first file, so the others can be attributed to the
/// drive whenever writing stops.
const std::string& made(const std::string& directory, const DriveSpec& spec,
                        const SensorModel& sensor) {
  make_directory(directory);
  write_drive_json(in(directory, "drive.json"), spec, sensor);
  return directory;
}

std::vector<double> column_truth(const std::vector<Pose>& poses) {
  std::vector<double> values;
  values.reserve(7 * poses.size());
  for (const Pose& pose : poses) {
    Eigen::Quaterniond q(pose.linear());
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d t = pose.translation();
    values.insert(values.end(), {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
  }
  // Sines of different mathematics libraries differ in the last digits; the file need not.
  for (double& value : values) value = std::round(value * 1e12) / 1e12;
  return values;
}

}  // namespace

DriveWriter::DriveWriter(const std::string& directory, const DriveSpec& spec,
                         const SensorModel& sensor, ExtraFormats extra)
    : directory_(made(directory, spec, sensor)),
      sensor_(sensor),
      extra_(extra),
      stack_(in(directory, "scans.npy"), sensor.rows(), sensor.columns),
      intensity_(in(directory, "intensity.npy"), {sensor.rows(), sensor.columns}),
      columns_(in(directory, "truth_columns.npy"), {sensor.columns, 7}) {
  write_whole_file(in(directory, "truth.tum"), "");
  write_whole_file(in(directory, "truth.kitti"), "");
  write_sensor_json(sensor, in(directory, "sensor.json"));
  if (spec.sensor_errors != SensorErrors::kNone) {
    write_sensor_errors_json(in(directory, "sensor_errors.json"), spec, sensor.rows());
  }
  if (extra_.imu) {
    write_whole_file(
        in(directory, "imu.csv"),
        "stamp_s,angular_rate_x_rad_per_s,angular_rate_y_rad_per_s,angular_rate_z_rad_per_s,"
        "specific_force_x_mps2,specific_force_y_mps2,specific_force_z_mps2\n");
  }
  if (extra_.kitti_bin) make_empty_directory(fs::path(directory) / "bin");
  if (extra_.pcd) make_empty_directory(fs::path(directory) / "pcd");
}

void DriveWriter::append(const SimulatedScan& scan) {
  intensity_.append(scan.intensity);  // first: no image may be without
  stack_.append(scan.image);
  columns_.append(column_truth(scan.T_map_sensor_at_column));
  const StampedPose pose{scan.stamp_s, scan.T_map_sensor};
  append_text("truth.tum", tum_line(pose));
  append_text("truth.kitti", kitti_line(pose));
  if (extra_.kitti_bin || extra_.pcd) write_extra(scan);
  if (extra_.imu) append_imu(scan.imu);
  ++scans_;
}

void DriveWriter::append_text(const char* name, const std::string& text) const {
  const std::string path = in(directory_, name);
  std::ofstream stream(path, std::ios::binary | std::ios::app);
  stream << text;
  stream.close();
  if (stream) return;
  throw Error("{}: cannot be written; check that the folder is writable and has free space", path);
}

void DriveWriter::append_imu(const std::vector<SimulatedImuSample>& samples) const {
  std::string lines;
  for (const SimulatedImuSample& sample : samples) {
    const Eigen::Vector3d& rate = sample.angular_rate_rad_per_s;
    const Eigen::Vector3d& force = sample.specific_force_mps2;
    lines += fmt::format("{:.3f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", sample.stamp_s,
                         rate.x(), rate.y(), rate.z(), force.x(), force.y(), force.z());
  }
  append_text("imu.csv", lines);
}

void DriveWriter::write_extra(const SimulatedScan& simulated) const {
  // Without times or rings, as such files often are.
  OrganizedCloud cloud = unproject(simulated.image, sensor_, CaptureTime::kMotionCorrected);
  cloud.intensity.assign(simulated.intensity.begin(), simulated.intensity.end());
  Scan scan = returns_of(cloud);
  scan.row.clear();
  const fs::path directory(directory_);
  if (extra_.kitti_bin) {
    replace_file((directory / "bin" / fmt::format("{:06}.bin", scans_)).string(),
                 [&](const std::string& part) { write_kitti_bin(scan, part); });
  }
  if (extra_.pcd) {
    replace_file((directory / "pcd" / fmt::format("{:06}.pcd", scans_)).string(),
                 [&](const std::string& part) { write_cloud(scan, part); });
  }
}

}  // namespace hqslam::sim
