#include "hqslam/core/projection.h"
#include "made_images.h"

namespace hqslam {
namespace {

SensorModel two_beams() {
  SensorModel sensor = beams_at({0.1, -0.2}, 16);
  sensor.elevation_correction_rad = {0.01, -0.02};
  sensor.range_correction_m = {0.5, -0.25};
  return sensor;
}

}  // namespace

TEST_CASE("a cloud's points are along corrected beams at corrected ranges") {
  const SensorModel sensor = two_beams();
  RangeImage image(2, 16);
  image.at(0, 3) = 10.0F;
  image.at(1, 3) = 20.0F;
  image.at(1, 4) = 0.2F;
  const OrganizedCloud cloud = unproject(image, sensor, CaptureTime::kRolling);
  const OrganizedCloud moved = calibrated(cloud, sensor);
  SensorModel corrected = sensor;
  corrected.beam_elevation_rad = {0.11, -0.22};
  image = RangeImage(2, 16);
  image.at(0, 3) = 10.5F;
  image.at(1, 3) = 19.75F;
  const OrganizedCloud expected = unproject(image, corrected, CaptureTime::kRolling);
  for (std::size_t i = 0; i < moved.points_m.size(); ++i) {
    CHECK((moved.points_m[i] - expected.points_m[i]).norm() < 1e-5F);
    CHECK(moved.range_m[i] == doctest::Approx(expected.range_m[i]));
  }
  CHECK(moved.time_offset_s == cloud.time_offset_s);
  corrected.elevation_correction_rad.clear();
  corrected.range_correction_m.clear();
  CHECK(calibrated(cloud, corrected).points_m == cloud.points_m);
}

TEST_CASE("a sensor's corrections go with its rows, and through its file") {
  const SensorModel sensor = two_beams();
  CHECK(sensor_from_json(sensor_json(sensor), "two.json").range_correction_m ==
        sensor.range_correction_m);
  CHECK(sensor_from_json(sensor_json(sensor), "two.json").elevation_correction_rad[1] ==
        doctest::Approx(-0.02));
  const SensorModel lower = select_rows(sensor, {1, 2});
  CHECK(lower.elevation_correction_rad == std::vector<double>{-0.02});
  CHECK(lower.range_correction_m == std::vector<double>{-0.25});
}

TEST_CASE("corrections of some beams only, or too large for a calibration, are refused") {
  SensorModel sensor = two_beams();
  sensor.range_correction_m.pop_back();
  CHECK_THROWS_WITH_AS(validate(sensor),
                       "sensor 'made': 2 corrections of elevation and 1 of range for 2 beams, "
                       "expected as many or none",
                       Error);
  sensor = two_beams();
  sensor.elevation_correction_rad[0] = 0.2;
  CHECK_THROWS_AS(validate(sensor), Error);
  CHECK_THROWS_AS(calibrated(OrganizedCloud(3, 16), two_beams()), Error);
}

}  // namespace hqslam
