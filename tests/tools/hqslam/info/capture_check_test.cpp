#include "info/capture_check.h"

#include "hqslam/core/npy.h"
#include "hqslam/sim/drive.h"
#include "testing.h"

namespace hqslam::test {

namespace {

/// The scan as if all of it had been measured at its stamp, by the true way of the sensor.
RangeImage corrected(const sim::SimulatedScan& scan, const SensorModel& sensor) {
  const OrganizedCloud cloud = unproject(scan.image, sensor, CaptureTime::kRolling);
  Scan points;
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t pixel = cloud.index(row, column);
      if (!(cloud.range_m[pixel] > 0.0F)) continue;
      const auto head = static_cast<std::size_t>(sensor.firing_column(row, column));
      const Pose T_stamp_point = scan.T_map_sensor.inverse() * scan.T_map_sensor_at_column[head];
      points.points_m.push_back(
          (T_stamp_point * cloud.points_m[pixel].cast<double>()).cast<float>());
      points.row.push_back(static_cast<std::uint16_t>(row));
    }
  }
  return range_image(project(points, sensor).cloud);
}

}  // namespace

TEST_CASE("scans tell whether they were corrected for motion") {
  const SensorModel sensor = sensor_preset("os1-16");
  const TemporaryDirectory folder;
  sim::DriveSpec spec = sim::drive_preset("town");
  spec.seed = 7;
  spec.scans = 40;
  spec.sensor_errors = sim::SensorErrors::kTypical;
  {
    sim::DriveSimulator simulator(spec, sensor);
    NpyStackWriter rolling(folder.file("rolling.npy"), sensor.rows(), sensor.columns);
    NpyStackWriter corrected_stack(folder.file("corrected.npy"), sensor.rows(), sensor.columns);
    NpyStackWriter standing(folder.file("standing.npy"), sensor.rows(), sensor.columns);
    std::optional<RangeImage> first;
    while (const auto scan = simulator.next()) {
      if (!first) first = scan->image;
      rolling.append(scan->image);
      corrected_stack.append(corrected(*scan, sensor));
      standing.append(*first);
    }
  }
  const auto rolling = tools::check_capture(folder.file("rolling.npy"), sensor);
  CHECK(rolling.verdict == CaptureTime::kRolling);
  CHECK(rolling.scans > 20);
  CHECK(rolling.rolling_m < rolling.corrected_m);
  const auto corrected = tools::check_capture(folder.file("corrected.npy"), sensor);
  CHECK(corrected.verdict == CaptureTime::kMotionCorrected);
  CHECK(corrected.corrected_m < corrected.rolling_m);
  const auto standing = tools::check_capture(folder.file("standing.npy"), sensor);
  CHECK_FALSE(standing.verdict.has_value());
  CHECK(standing.scans == 0);
}

}  // namespace hqslam::test
