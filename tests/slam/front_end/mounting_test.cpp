#include "front_end/mounting.h"

#include "slam/yard.h"

using namespace hqslam::slam;

namespace {

MountingOptions mounted(double roll_rad, double pitch_rad) { return {roll_rad, pitch_rad, false}; }

Pose level_from_sensor(double roll_rad, double pitch_rad) {
  return pose_from_xyz_rpy(Eigen::Vector3d::Zero(), roll_rad, pitch_rad, 0.0);
}

/// A scan of the yard by a tilted sensor.
OrganizedCloud leaning_scan(const SensorModel& sensor, double roll_rad, double pitch_rad) {
  return Yard().scan(sensor, yard_pose(2.0, 1.0, 0.4) * level_from_sensor(roll_rad, pitch_rad));
}

}  // namespace

TEST_CASE("a level sensor's scan is left as it is, and so are its poses, bit for bit") {
  const SensorModel sensor = small_sensor(4, 16);
  const Mounting mounting({}, sensor);
  CHECK_FALSE(mounting.level(leaning_scan(sensor, 0.0, 0.0)).has_value());
  CHECK(mounting.upright_sensor() == sensor);
  CHECK(mounting.up_of_upright_sensor() == Eigen::Vector3d::UnitZ());
  const Pose T = yard_pose(1.0, 2.0, 0.3);
  CHECK(mounting.of_sensor(T).matrix() == T.matrix());
}

TEST_CASE("a scan upside down becomes one of an upright sensor: rows and columns from behind") {
  SensorModel sensor = small_sensor(8, 64);
  sensor.measured_rows = RowSelection{1, 3};  // rows 1, 4, 7
  sensor.beam_azimuth_offset_rad[0] = 0.01;
  const Mounting mounting(mounted(std::numbers::pi, 0.0), sensor);
  const SensorModel& upright = mounting.upright_sensor();
  CHECK_NOTHROW(validate(upright));
  CHECK(upright.beam_elevation_rad.front() == -sensor.beam_elevation_rad.back());
  CHECK(upright.beam_azimuth_offset_rad.back() == -0.01);
  CHECK(upright.measured_rows == RowSelection{0, 3});  // rows 0, 3, 6

  const auto level = mounting.level(leaning_scan(sensor, std::numbers::pi, 0.0));
  REQUIRE(level.has_value());
  const OrganizedCloud seen = Yard().scan(upright, yard_pose(2.0, 1.0, 0.4));
  for (std::size_t i = 0; i < seen.range_m.size(); ++i) {
    CHECK((level->points_m[i] - seen.points_m[i]).norm() < 1e-3F * (1.0F + seen.range_m[i]));
  }
}

TEST_CASE("the vertical of an upright sensor is up, though the real one hangs") {
  const Eigen::Vector3d up =
      Mounting(mounted(std::numbers::pi, 0.2), small_sensor(4, 16)).up_of_upright_sensor();
  CHECK(up.x() == doctest::Approx(-std::sin(0.2)));
  CHECK(std::abs(up.y()) < 1e-9);
  CHECK(up.z() == doctest::Approx(std::cos(0.2)));
}

TEST_CASE("a covariance turns with the sensor, and an infinite one stays") {
  const Mounting mounting(mounted(std::numbers::pi / 2.0 - 0.6, 0.0), small_sensor());
  const Vector6 variance = (Vector6() << 1.0, 4.0, 9.0, 0.1, 0.4, 0.9).finished();
  const Eigen::Matrix3d R = R_level_sensor(mounting.mounted());
  const Matrix6 turned = mounting.of_sensor(Matrix6(variance.asDiagonal()));
  const Eigen::Matrix3d expected = R.transpose() * variance.head<3>().asDiagonal() * R;
  CHECK((turned.topLeftCorner<3, 3>() - expected).norm() < 1e-12);
  const Matrix6 unknown =
      Matrix6(Vector6::Constant(std::numeric_limits<double>::infinity()).asDiagonal());
  CHECK(mounting.of_sensor(unknown).diagonal() == unknown.diagonal());
}

TEST_CASE("a sensor's tilt, upright or not, follows from one scan's ground to 0.05 degrees") {
  for (const char* name : {"vlp-16", "os1-16", "os1-64"}) {
    const SensorModel sensor = sensor_preset(name);
    for (const auto& [mounted_roll_deg, roll_deg, pitch_deg] : {std::array{0.0, 0.0, 0.0},
                                                                {0.0, 3.0, -2.0},
                                                                {0.0, 0.0, 20.0},
                                                                {0.0, -14.0, 14.0},
                                                                {180.0, 185.0, 0.0}}) {
      CAPTURE(name);
      const double roll_rad = roll_deg * kDegree_rad;
      const double pitch_rad = pitch_deg * kDegree_rad;
      CAPTURE(roll_rad);
      CAPTURE(pitch_rad);
      Mounting mounting({mounted_roll_deg * kDegree_rad, 0.0, true}, sensor);
      REQUIRE(mounting.correct_from_ground(leaning_scan(sensor, roll_rad, pitch_rad)));
      const Pose found(R_level_sensor(mounting.mounted()));
      CHECK(rotation_angle_rad(found.inverse() * level_from_sensor(roll_rad, pitch_rad)) <
            0.05 * kDegree_rad);
    }
  }
}

TEST_CASE("a mounting is corrected without being asked where the ground is off by five degrees") {
  const SensorModel sensor = sensor_preset("os1-16");
  for (const auto& [stated_deg, pitch_deg, is_corrected] : {std::tuple{0.0, 0.0, false},
                                                            {0.0, 4.0, false},
                                                            {0.0, -7.0, true},
                                                            {0.0, 28.0, true},
                                                            {10.0, 13.0, false},
                                                            {10.0, -10.0, true}}) {
    CAPTURE(stated_deg);
    CAPTURE(pitch_deg);
    Mounting mounting(mounted(0.0, stated_deg * kDegree_rad), sensor);
    REQUIRE(mounting.correct_from_ground(leaning_scan(sensor, 0.0, pitch_deg * kDegree_rad)));
    CHECK(mounting.is_compared());
    CHECK(mounting.mounted().estimated == is_corrected);
    const double expected_deg = is_corrected ? pitch_deg : stated_deg;
    CHECK(std::abs(mounting.mounted().pitch_rad - expected_deg * kDegree_rad) < 1e-3);
  }
}

TEST_CASE("a bank beside the road is not the ground of a sensor that leans") {
  const SensorModel sensor = sensor_preset("os1-64");
  const RangeImage image = made_image(sensor, [](int, int, const Eigen::Vector3d& beam) {
    const double road_m = beam.z() < 0.0 ? -1.8 / beam.z() : 1e9;
    // From two metres to the left a bank rises by 25 degrees; to the right the land falls away.
    const double rise = std::tan(25.0 * kDegree_rad);
    const double steep = beam.z() - rise * beam.y();
    const double bank_m = beam.y() > 0.0 && steep < 0.0 ? (-1.8 - 2.0 * rise) / steep : 1e9;
    const double range_m = std::min(road_m, bank_m);
    return range_m < 40.0 && beam.y() * range_m > -5.0 ? range_m : 0.0;
  });
  Mounting mounting({}, sensor);
  CHECK(mounting.correct_from_ground(unproject(image, sensor, CaptureTime::kMotionCorrected)));
  CHECK_FALSE(mounting.mounted().estimated);
}

TEST_CASE("without ground nothing is estimated") {
  const SensorModel sensor = sensor_preset("os1-16");
  Mounting mounting(mounted(0.1, 0.0), sensor);
  const Eigen::Matrix3d R = R_level_sensor(mounting.mounted());
  CHECK_FALSE(mounting.correct_from_ground(OrganizedCloud(sensor.rows(), sensor.columns)));
  // Walls alone.
  OrganizedCloud walls = leaning_scan(sensor, 0.0, 0.0);
  for (std::size_t i = 0; i < walls.range_m.size(); ++i) {
    if (walls.points_m[i].z() < -1.0F) walls.range_m[i] = 0.0F;
  }
  CHECK_FALSE(mounting.correct_from_ground(walls));
  // A line of ground: every plane through it fits.
  OrganizedCloud line = leaning_scan(sensor, 0.0, 0.0);
  for (int row = 0; row < line.rows; ++row) {
    for (int column = 0; column < line.columns; ++column) {
      if (column % 512 != 100) line.range_m[line.index(row, column)] = 0.0F;
    }
  }
  CHECK_FALSE(mounting.correct_from_ground(line));
  CHECK(R_level_sensor(mounting.mounted()) == R);
}
