#include "hqslam/core/projection.h"

#include <Eigen/Geometry>

#include "made_images.h"

using hqslam::test::refused_with;

namespace {

RangeImage random_image(const SensorModel& sensor, unsigned seed) {
  std::mt19937 generator(seed);
  return made_image(sensor.rows(), sensor.columns, [&](int, int) {
    const auto value = static_cast<double>(generator() % 1000);
    return value < 200.0 ? 0.0 : 2.0 + 0.05 * value;
  });
}

}  // namespace

TEST_CASE("project inverts unproject for every preset, with rows given or found by elevation") {
  for (const std::string& name : sensor_preset_names()) {
    const SensorModel sensor = sensor_preset(name);
    const RangeImage image = random_image(sensor, 7);
    const OrganizedCloud cloud = unproject(image, sensor, CaptureTime::kRolling);
    for (const bool with_rows : {true, false}) {
      Scan scan = returns_of(cloud);
      if (!with_rows) scan.row.clear();
      const auto projected = project(scan, sensor);
      CAPTURE(name);
      CHECK(projected.counts.outside_rows == 0);
      CHECK(projected.counts.hidden_by_nearer == 0);
      CHECK(projected.counts.out_of_range == 0);
      REQUIRE(projected.cloud.range_m.size() == image.range_m.size());
      double worst_m = 0.0;
      double worst_s = 0.0;
      for (std::size_t i = 0; i < image.range_m.size(); ++i) {
        worst_m =
            std::max<double>(worst_m, std::abs(projected.cloud.range_m[i] - image.range_m[i]));
        if (image.range_m[i] <= 0.0F) continue;
        worst_s = std::max<double>(
            worst_s, std::abs(projected.cloud.time_offset_s[i] - cloud.time_offset_s[i]));
      }
      CHECK(worst_m < 1e-4);
      CHECK(worst_s == 0.0);
    }
  }
}

TEST_CASE("the times of a scan's points give where in the turn it begins") {
  for (const char* name : {"os1-64", "vlp-16"}) {
    CAPTURE(name);
    const SensorModel sensor = sensor_preset(name);
    RangeImage image(sensor.rows(), sensor.columns);
    for (int column = 0; column < sensor.columns; column += 3) image.at(5, column) = 10.0F;
    CHECK(first_column(unproject(image, sensor, CaptureTime::kMotionCorrected), sensor) == 0);
    for (const int first : {0, 1, sensor.columns / 2, sensor.columns - 1}) {
      const OrganizedCloud cloud = unproject(image, sensor, CaptureTime::kRolling, first);
      CHECK(first_column(cloud, sensor) == first);
      for (int column = 0; column < sensor.columns; ++column) {
        if (sensor.firing_column(5, column) != first) continue;
        CHECK(cloud.time_offset_s[cloud.index(5, column)] ==
              doctest::Approx((0.5 / sensor.columns - 0.5) * sensor.scan_period_s));
      }
    }
  }
}

TEST_CASE("the nearest return wins a pixel, that of the beam and the azimuth, in whatever order") {
  Scan scan;
  const Eigen::Vector3f direction(1.0F, 0.001F, std::tan(0.0174533F));
  scan.points_m = {20.0F * direction, 5.0F * direction, 10.0F * direction};
  const auto projected = project(scan, sensor_preset("vlp-16"));
  CHECK(projected.counts.kept == 1);
  CHECK(projected.counts.hidden_by_nearer == 2);
  CHECK(projected.cloud.points_m[projected.cloud.index(7, 899)].isApprox(5.0F * direction));
}

TEST_CASE("an intensity goes where its point goes") {
  Scan scan;
  scan.points_m = {{9.0F, 0.01F, 0.0F}, {5.0F, 0.01F, 0.0F}, {0.0F, 7.0F, 0.0F}};
  scan.intensity = {1.0F, 2.0F, 3.0F};
  const OrganizedCloud cloud = project(scan, sensor_preset("vlp-16")).cloud;
  CHECK(returns_of(cloud).intensity == std::vector<float>{3.0F, 2.0F});
  scan.intensity.pop_back();
  CHECK(refused_with([&] { project(scan, sensor_preset("vlp-16")); }, "2 intensities"));
}

TEST_CASE("points outside the ranges or the beams are left out and counted") {
  const SensorModel sensor = sensor_preset("vlp-16");
  Scan scan;
  scan.points_m = {{0.1F, 0, 0}, {500, 0, 0}, {5, 0, 5}, {5, 0, -5}, {0, 0, 0}};
  const auto projected = project(scan, sensor);
  CHECK(projected.counts.out_of_range == 3);
  CHECK(projected.counts.outside_rows == 2);
  CHECK(projected.counts.kept == 0);
  // A point at the origin is no return, even of a sensor that measures from 0 m on.
  SensorModel near = sensor;
  near.min_range_m = 0.0;
  scan.points_m = {{0, 0, 0}, {0.001F, 0, 0}};
  scan.row = {7, 7};
  CHECK(project(scan, near).counts.out_of_range == 1);
  CHECK(project(scan, near).counts.kept == 1);
}

TEST_CASE("a sensor sees half a beam spacing beyond its outermost beams") {
  const SensorModel sensor = sensor_preset("vlp-16");  // 15 to -15 degrees, 2 apart
  const auto row_at = [&](double elevation_deg) {
    Scan scan;
    scan.points_m = {
        {10.0F, 0.01F, 10.0F * static_cast<float>(std::tan(elevation_deg * 0.0174533))}};
    const auto projected = project(scan, sensor);
    for (int row = 0; row < 16; ++row) {
      if (projected.cloud.range_m[projected.cloud.index(row, 899)] > 0.0F) return row;
    }
    CHECK(projected.counts.outside_rows == 1);
    return -1;
  };
  CHECK(row_at(15.9) == 0);
  CHECK(row_at(16.1) == -1);
  CHECK(row_at(-15.9) == 15);
  CHECK(row_at(-16.1) == -1);
  CHECK(row_at(2.1) == 6);  // nearer to 3 degrees than to 1
  CHECK(row_at(1.9) == 7);
}

TEST_CASE("rows that count from the lowest beam, or points with other axes, are refused") {
  const SensorModel sensor = sensor_preset("vlp-16");
  const Scan scan = returns_of(unproject(random_image(sensor, 7), sensor, CaptureTime::kRolling));
  Scan from_lowest = scan;
  for (std::uint16_t& row : from_lowest.row) row = static_cast<std::uint16_t>(15 - row);
  CHECK(refused_with([&] { project(from_lowest, sensor); }, "15 - ring"));
  Scan camera_axes = scan;            // x right, y down, z forward
  camera_axes.points_m[0].setZero();  // no return
  for (auto& point_m : camera_axes.points_m) point_m = {-point_m.y(), -point_m.z(), point_m.x()};
  CHECK(refused_with([&] { project(camera_axes, sensor); }, "z up"));
  Scan tilted = scan;  // by 10 degrees
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(0.1745F, Eigen::Vector3f::UnitY()).matrix();
  for (auto& point_m : tilted.points_m) point_m = turn * point_m;
  CHECK(project(tilted, sensor).counts.kept > 1000);
}

TEST_CASE("a row that the sensor does not have and a shape that is not its own are refused") {
  const SensorModel sensor = sensor_preset("vlp-16");
  Scan scan;
  scan.points_m = {{5, 0, 0}};
  scan.row = {16};
  CHECK_THROWS_AS(project(scan, sensor), Error);
  scan.row = {1, 2};
  CHECK_THROWS_AS(project(scan, sensor), Error);
  CHECK_THROWS_AS(unproject(RangeImage(64, 1024), sensor, CaptureTime::kRolling), Error);
}

TEST_CASE("rows selected from a cloud are those selected from its image") {
  const SensorModel sensor = sensor_preset("os1-64");
  const RangeImage image = random_image(sensor, 3);
  const auto rows = selection_for(64, 16);
  const OrganizedCloud all = unproject(image, sensor, CaptureTime::kRolling);
  const OrganizedCloud selected = select_rows(all, rows);
  const OrganizedCloud direct =
      unproject(select_rows(image, rows), select_rows(sensor, rows), CaptureTime::kRolling);
  CHECK(selected.rows == 16);
  CHECK(selected.points_m == direct.points_m);
  CHECK(selected.time_offset_s == direct.time_offset_s);
  CHECK(range_image(selected).range_m == direct.range_m);
}

TEST_CASE("the points of a cloud are those of the pixels with a return, row by row") {
  OrganizedCloud cloud(2, 2);
  cloud.points_m[1] = {1.0F, 2.0F, 2.0F};
  cloud.range_m[1] = 3.0F;
  cloud.points_m[2] = {0.0F, 4.0F, 0.0F};
  cloud.range_m[2] = 4.0F;
  CHECK(points_of(cloud) == std::vector<Eigen::Vector3f>{{1.0F, 2.0F, 2.0F}, {0.0F, 4.0F, 0.0F}});
  cloud.intensity = {1.0F, 2.0F, 3.0F, 4.0F};
  const Scan scan = returns_of(cloud);
  CHECK(scan.points_m == points_of(cloud));
  CHECK(scan.row == std::vector<std::uint16_t>{0, 1});
  CHECK(scan.intensity == std::vector<float>{2.0F, 3.0F});
  CHECK(scan.time_offset_s.empty());
}
