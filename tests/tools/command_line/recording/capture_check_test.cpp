#include "recording/capture_check.h"

#include "hqslam/core/npy.h"
#include "hqslam/core/point_columns.h"
#include "hqslam/sim/drive.h"
#include "testing.h"

namespace hqslam::test {
namespace {

/// The scan as if all of it had been measured at its stamp, by the true way of the sensor. Its
/// points still have their times.
Scan corrected_points(const sim::SimulatedScan& scan, const SensorModel& sensor) {
  const OrganizedCloud cloud = unproject(scan.image, sensor, CaptureTime::kRolling);
  Scan points = returns_of(cloud);
  std::size_t i = 0;
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      if (!(cloud.range_m[cloud.index(row, column)] > 0.0F)) continue;
      const auto head = static_cast<std::size_t>(sensor.firing_column(row, column));
      const Pose T_stamp_point = scan.T_map_sensor.inverse() * scan.T_map_sensor_at_column[head];
      points.points_m[i] = (T_stamp_point * points.points_m[i].cast<double>()).cast<float>();
      ++i;
    }
  }
  return points;
}

RangeImage corrected(const sim::SimulatedScan& scan, const SensorModel& sensor) {
  return range_image(project(corrected_points(scan, sensor), sensor).cloud);
}

void write_with_times(const Scan& scan, const std::string& path) {
  const float* const first_m = scan.points_m.front().data();
  const std::size_t step = sizeof(Eigen::Vector3f);
  write_points({{"x", {'F', 4}, first_m, step},
                {"y", {'F', 4}, first_m + 1, step},
                {"z", {'F', 4}, first_m + 2, step},
                {"ring", {'U', 2}, scan.row.data(), sizeof(std::uint16_t)},
                {"t", {'F', 4}, scan.time_offset_s.data(), sizeof(float)}},
               scan.points_m.size(), path);
}

}  // namespace

TEST_CASE("scans determine whether they were corrected for motion, and how many turns apart") {
  const SensorModel sensor = sensor_preset("os1-16");
  const TemporaryDirectory folder;
  const std::string corrected_clouds = folder.file("corrected");
  std::filesystem::create_directory(corrected_clouds);
  {
    sim::DriveSimulator simulator({"town", 7, 40, {}, {}, sim::SensorErrors::kTypical}, sensor);
    NpyStackWriter rolling(folder.file("rolling.npy"), sensor.rows(), sensor.columns);
    NpyStackWriter corrected_stack(folder.file("corrected.npy"), sensor.rows(), sensor.columns);
    NpyStackWriter thinned(folder.file("thinned.npy"), sensor.rows(), sensor.columns);
    NpyStackWriter standing(folder.file("standing.npy"), sensor.rows(), sensor.columns);
    std::optional<RangeImage> first;
    for (int i = 0; const auto scan = simulator.next(); ++i) {
      if (!first) first = scan->image;
      rolling.append(scan->image);
      if (i % 2 == 0) thinned.append(scan->image);
      corrected_stack.append(corrected(*scan, sensor));
      standing.append(*first);
      write_with_times(corrected_points(*scan, sensor),
                       fmt::format("{}/{:02}.pcd", corrected_clouds, i));
    }
  }
  const auto rolling = tools::check_capture(folder.file("rolling.npy"), sensor);
  CHECK(rolling.verdict == CaptureTime::kRolling);
  CHECK(rolling.scans > 20);
  CHECK(rolling.rolling_m < rolling.corrected_m);
  CHECK(rolling.turns == 1);
  const auto thinned = tools::check_capture(folder.file("thinned.npy"), sensor);
  CHECK(thinned.verdict == CaptureTime::kRolling);
  CHECK(thinned.turns == 2);
  const auto corrected = tools::check_capture(folder.file("corrected.npy"), sensor);
  CHECK(corrected.verdict == CaptureTime::kMotionCorrected);
  CHECK(corrected.corrected_m < corrected.rolling_m);
  CHECK(corrected.turns == 1);
  recordings::OpenOptions stated;
  stated.sensor = "os1-16";
  stated.files.capture = CaptureTime::kMotionCorrected;
  CHECK_FALSE(tools::check_clouds_without_times(folder.file("corrected.npy"), stated).has_value());
  // Clouds that were corrected and still have their times.
  CHECK(tools::check_capture(corrected_clouds, sensor).verdict == CaptureTime::kMotionCorrected);
  const auto standing = tools::check_capture(folder.file("standing.npy"), sensor);
  CHECK_FALSE(standing.verdict.has_value());
  CHECK(standing.scans == 0);
}

}  // namespace hqslam::test
