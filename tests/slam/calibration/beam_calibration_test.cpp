#include "hqslam/slam/beam_calibration.h"

#include "slam/yard.h"
#include "thread_limit.h"

namespace hqslam {
namespace {

constexpr int kRows = 16;
constexpr double kHeight_m = 1.7;  ///< of yard_pose

/// A sensor whose beams have errors of elevation and range against `sensor`.
struct BiasedSensor {
  SensorModel sensor = small_sensor(kRows, 512);
  std::vector<double> elevation_rad;  ///< truth minus the model
  std::vector<double> range_m;        ///< truth minus what is measured

  /// Its measured scan of a yard.
  OrganizedCloud scan(const Yard& yard, const Pose& T_yard_sensor) const {
    SensorModel true_sensor = sensor;
    for (int row = 0; row < kRows; ++row) true_sensor.beam_elevation_rad[row] += elevation_rad[row];
    RangeImage image = range_image(yard.scan(true_sensor, T_yard_sensor));
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < image.columns; ++column) {
        float& pixel = image.at(row, column);
        if (pixel > 0.0F) pixel -= static_cast<float>(range_m[row]);
      }
    }
    return unproject(image, sensor, CaptureTime::kMotionCorrected);
  }
};

BiasedSensor biased_sensor(double elevation_deg, double range_m) {
  BiasedSensor result;
  for (int row = 0; row < kRows; ++row) {
    // Mean zero, no trend from row to row: no bent world has this pattern.
    result.elevation_rad.push_back(elevation_deg * kDegree_rad * (row % 2 == 0 ? 1.0 : -1.0));
    result.range_m.push_back(range_m * ((row / 2) % 2 == 0 ? 1.0 : -1.0));
  }
  return result;
}

/// Scans around the yard, with errors of the poses of centimetres, as those of SLAM.
std::vector<slam::LocatedScan> drive(const BiasedSensor& sensor, double step_m = 1.0) {
  const Yard yard{.half_width_m = 10.0};
  std::vector<slam::LocatedScan> scans;
  for (int i = 0; i < 40.0 / step_m; ++i) {
    const Pose truth = yard_pose(-20.0 + step_m * i, 5.0 * std::sin(0.15 * i), 0.1 * i);
    Pose estimated = truth;
    estimated.translation() +=
        Eigen::Vector3d(0.01 * std::sin(i), 0.01 * std::cos(2 * i), 0.01 * std::sin(3 * i));
    scans.push_back({sensor.scan(yard, truth), estimated, {}});
  }
  return scans;
}

}  // namespace

TEST_CASE("the distances of beams from walls and ground are found to millimetres") {
  const BiasedSensor sensor = biased_sensor(0.06, 0.02);
  const slam::BeamCalibration found = slam::calibrate_beams(sensor.sensor, drive(sensor));
  REQUIRE(found.beams.size() == kRows);
  int met_walls = 0;
  for (std::size_t row = 0; row < kRows; ++row) {
    CAPTURE(row);
    const slam::BeamCorrection& beam = found.beams[row];
    const double range_error_m = beam.range_m - sensor.range_m[row];
    if (beam.range_sigma_m < 0.010) {
      ++met_walls;
      CHECK(std::abs(range_error_m) < 0.006);
    }
    // A ring on the ground alone determines a height, not the shares of range and elevation in it.
    const double elevation_rad = sensor.sensor.beam_elevation_rad[row];
    if (elevation_rad > -0.08) continue;
    const double ground_m = kHeight_m / std::tan(-elevation_rad);
    const double turn_rad = beam.elevation_rad - sensor.elevation_rad[row];
    CHECK(std::abs(range_error_m * std::sin(elevation_rad) + ground_m * turn_rad) < 0.005);
    REQUIRE(beam.before.ground_m);
    REQUIRE(beam.after.ground_m);
    CHECK(std::abs(*beam.after.ground_m) < 0.3 * std::abs(*beam.before.ground_m) + 0.002);
  }
  CHECK(met_walls >= kRows / 2);
  CHECK(found.residual_after_m < 0.5 * found.residual_before_m);
}

TEST_CASE("beams that are right stay as they are, whatever the poses gain") {
  const BiasedSensor sensor = biased_sensor(0.0, 0.0);
  const slam::BeamCalibration found = slam::calibrate_beams(sensor.sensor, drive(sensor));
  for (const slam::BeamCorrection& beam : found.beams) {
    CHECK(std::abs(beam.elevation_rad) < 0.005 * kDegree_rad);
    CHECK(std::abs(beam.range_m) < 0.002);
  }
  CHECK(found.residual_after_m > 0.98 * found.residual_before_m);
}

TEST_CASE("the same scans give the same calibration, bit for bit, with any number of threads") {
  const BiasedSensor sensor = biased_sensor(0.06, 0.02);
  // So many poses that Eigen would share its products among threads.
  const std::vector<slam::LocatedScan> scans = drive(sensor, 0.5);
  std::vector<slam::BeamCalibration> found;
  for (const int count : {1, 2}) {
    const slam::ThreadLimit limit(count);
    found.push_back(slam::calibrate_beams(sensor.sensor, scans));
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    CHECK(found[0].beams[row].elevation_rad == found[1].beams[row].elevation_rad);
    CHECK(found[0].beams[row].range_m == found[1].beams[row].range_m);
    CHECK(found[0].beams[row].range_sigma_m == found[1].beams[row].range_sigma_m);
  }
}

TEST_CASE("unobservable parameters keep their prior and its sigma") {
  const BiasedSensor sensor = biased_sensor(0.06, 0.02);
  const OrganizedCloud empty(kRows, sensor.sensor.columns);
  for (const auto& scans : {std::vector<slam::LocatedScan>{},
                            std::vector<slam::LocatedScan>(3, {empty, Pose::Identity(), {}})}) {
    const slam::BeamCalibration found = slam::calibrate_beams(sensor.sensor, scans);
    CHECK(found.surfaces == 0);
    for (const slam::BeamCorrection& beam : found.beams) {
      CHECK(beam.elevation_rad == 0.0);
      CHECK(beam.range_m == 0.0);
      CHECK_FALSE(beam.before.ground_m);
      CHECK_FALSE(beam.after.walls_m);
      CHECK(beam.elevation_sigma_rad == doctest::Approx(0.05 * kDegree_rad));
      CHECK(beam.range_sigma_m == doctest::Approx(0.02));
    }
  }
}

TEST_CASE("scans of another sensor are refused") {
  const BiasedSensor sensor = biased_sensor(0.0, 0.0);
  const std::vector<slam::LocatedScan> scans = {{OrganizedCloud(8, 512), Pose::Identity(), {}}};
  CHECK_THROWS_WITH_AS(slam::calibrate_beams(sensor.sensor, scans),
                       "scan of 8x512 pixels does not fit sensor 'small' of 16x512: name the "
                       "sensor that recorded it",
                       Error);
  OrganizedCloud without_points(kRows, 512);
  without_points.points_m.clear();
  CHECK_THROWS_AS(slam::calibrate_beams(sensor.sensor, {{without_points, Pose::Identity(), {}}}),
                  Error);
}

}  // namespace hqslam
