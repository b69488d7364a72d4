#include "hqslam/nn/upsampled_cloud.h"

#include "hqslam/core/projection.h"
#include "made_images.h"

namespace hqslam::nn {
namespace {

constexpr RowSelection kMeasuredRows = {1, 2};

/// Six rows of 16 columns, of which rows 1, 3 and 5 are measured.
const SensorModel kSixRows = even_sensor(6, 16, 10.0, 4.0);

RangeImage image_with_holes() {
  return made_image(6, 16, [](int row, int column) {
    const int i = 16 * row + column;
    return i % 7 == 3 ? 0.0 : 5.0 + 0.1 * i;
  });
}

const RangeImage kTenMetres = flat_image(6, 16, 10.0F);

}  // namespace

TEST_CASE("what was measured is sure, also where a network takes it for too far") {
  RangeImage upsampled = kTenMetres;
  upsampled.at(1, 3) = 0.0F;
  const OrganizedCloud measured =
      unproject(select_rows(kTenMetres, kMeasuredRows), select_rows(kSixRows, kMeasuredRows),
                CaptureTime::kMotionCorrected);
  std::vector<float> confidence(upsampled.range_m.size(), 0.5F);
  confidence[upsampled.index(1, 3)] = 0.0F;
  confidence[upsampled.index(2, 5)] = 0.75F;
  const OrganizedCloud cloud =
      upsampled_cloud({upsampled, confidence}, measured, kMeasuredRows, kSixRows);
  CHECK(cloud.range_m[cloud.index(1, 3)] == doctest::Approx(10.0));
  CHECK(cloud.confidence[cloud.index(1, 3)] == 1.0F);
  CHECK(cloud.confidence[cloud.index(2, 3)] == 0.5F);
  CHECK(cloud.confidence[cloud.index(2, 5)] == 0.75F);
  CHECK(upsampled_cloud({upsampled, {}}, measured, kMeasuredRows, kSixRows).confidence.empty());
}

TEST_CASE("measured points and their times stay as they are, to the bit") {
  OrganizedCloud measured =
      select_rows(unproject(image_with_holes(), kSixRows, CaptureTime::kRolling), kMeasuredRows);
  for (std::size_t i = 0; i < measured.points_m.size(); ++i) {
    measured.points_m[i] *= 1.0F + 0.01F * static_cast<float>(i % 5);
    measured.time_offset_s[i] += 0.001F * static_cast<float>(i % 3);
  }
  const OrganizedCloud kept = select_rows(
      upsampled_cloud({RangeImage(6, 16), {}}, measured, kMeasuredRows, kSixRows), kMeasuredRows);
  CHECK(kept.points_m == measured.points_m);
  CHECK(kept.range_m == measured.range_m);
  CHECK(kept.time_offset_s == measured.time_offset_s);
}

TEST_CASE("a computed point is as bright as the measured ones above and below it make it") {
  OrganizedCloud measured =
      select_rows(unproject(kTenMetres, kSixRows, CaptureTime::kRolling), kMeasuredRows);
  measured.intensity.assign(measured.range_m.size(), 0.0F);
  for (int column = 0; column < 16; ++column) {
    measured.intensity[measured.index(0, column)] = 40.0F;
    measured.intensity[measured.index(1, column)] = 80.0F;
  }
  measured.range_m[measured.index(1, 1)] = 13.0F;  // far from the point between
  measured.range_m[measured.index(0, 2)] = 13.0F;
  measured.range_m[measured.index(0, 3)] = 0.0F;
  measured.range_m[measured.index(0, 4)] = measured.range_m[measured.index(1, 4)] = 0.0F;
  const OrganizedCloud cloud = upsampled_cloud({kTenMetres, {}}, measured, kMeasuredRows, kSixRows);
  const auto intensity = [&](int row, int column) {
    return cloud.intensity[cloud.index(row, column)];
  };
  CHECK(select_rows(cloud, kMeasuredRows).intensity == measured.intensity);
  CHECK(intensity(2, 0) == 60.0F);
  CHECK(intensity(0, 0) == 40.0F);  // nothing is above it
  CHECK(intensity(2, 1) == 40.0F);
  CHECK(intensity(2, 2) == 80.0F);
  CHECK(intensity(2, 3) == 80.0F);
  CHECK(std::isnan(intensity(2, 4)));
  measured.intensity.clear();
  CHECK(upsampled_cloud({kTenMetres, {}}, measured, kMeasuredRows, kSixRows).intensity.empty());
}

TEST_CASE("the scans of a sensor that keeps to its beam table become what unproject makes") {
  const RangeImage image = image_with_holes();
  for (const CaptureTime time : {CaptureTime::kRolling, CaptureTime::kMotionCorrected}) {
    const OrganizedCloud expected = unproject(image, kSixRows, time);
    const OrganizedCloud cloud =
        upsampled_cloud({image, {}}, select_rows(expected, kMeasuredRows), kMeasuredRows, kSixRows);
    CHECK(cloud.points_m == expected.points_m);
    CHECK(cloud.range_m == expected.range_m);
    CHECK(cloud.time_offset_s == expected.time_offset_s);
  }
}

TEST_CASE("a computed point deviates from its beam as the measured ones above and below do") {
  const RangeImage upsampled = flat_image(6, 16, 20.0F);
  OrganizedCloud measured(3, 16);
  const auto measure = [&](int measured_row, int column, double deviation_deg) {
    const int row = kMeasuredRows.offset + measured_row * kMeasuredRows.stride;
    const std::size_t pixel = measured.index(measured_row, column);
    measured.range_m[pixel] = 10.0F;
    const double elevation = kSixRows.beam_elevation_rad[row] + deviation_deg * kDegree_rad;
    measured.points_m[pixel] =
        (10.0 * direction_of(kSixRows.azimuth_rad(row, column), elevation)).cast<float>();
  };
  measure(0, 4, 0.2);
  measure(1, 4, 0.4);   // row 2 of column 4 is in the middle between the two
  measure(1, 5, 0.4);   // row 2 of column 5 has only the one below
  measure(0, 6, -0.3);  // row 0 is above the first measured row

  const OrganizedCloud cloud = upsampled_cloud({upsampled, {}}, measured, kMeasuredRows, kSixRows);
  const auto deviation_deg = [&](int row, int column) {
    const Eigen::Vector3d point_m = cloud.points_m[cloud.index(row, column)].cast<double>();
    return (std::asin(point_m.normalized().z()) - kSixRows.beam_elevation_rad[row]) / kDegree_rad;
  };
  CHECK(deviation_deg(2, 4) == doctest::Approx(0.3).epsilon(1e-3));
  CHECK(deviation_deg(2, 5) == doctest::Approx(0.4).epsilon(1e-3));
  CHECK(deviation_deg(0, 6) == doctest::Approx(-0.3).epsilon(1e-3));
  CHECK(std::abs(deviation_deg(2, 7)) < 1e-4);
  for (const int row : {0, 2, 4}) {
    for (int column = 0; column < 16; ++column) {
      const Eigen::Vector3f& point_m = cloud.points_m[cloud.index(row, column)];
      CHECK(point_m.norm() == doctest::Approx(20.0).epsilon(1e-6));
      CHECK(std::remainder(std::atan2(point_m.y(), point_m.x()) - kSixRows.azimuth_rad(row, column),
                           2.0 * 3.141592653589793) == doctest::Approx(0.0).epsilon(1e-6));
    }
  }
}

TEST_CASE("a computed point is as late as the measured ones near it, and stays inside the scan") {
  const OrganizedCloud model = unproject(kTenMetres, kSixRows, CaptureTime::kRolling);
  OrganizedCloud measured = select_rows(model, kMeasuredRows);
  constexpr float kLate_s = 0.03F;
  for (float& time_s : measured.time_offset_s) time_s = std::remainder(time_s + kLate_s, 0.1F);
  const OrganizedCloud cloud = upsampled_cloud({kTenMetres, {}}, measured, kMeasuredRows, kSixRows);
  for (int column = 0; column < 16; ++column) {
    const float time_s = cloud.time_offset_s[cloud.index(2, column)];
    CHECK(time_s == doctest::Approx(measured.time_offset_s[measured.index(1, column)]));
    CHECK(std::abs(time_s) <= 0.05F + 1e-6F);
  }
}

TEST_CASE("a computed point whose head began anew is not a turn too early") {
  SensorModel sensor = kSixRows;
  sensor.beam_azimuth_offset_rad[2] = sensor.column_step_rad();  // a column ahead of its neighbours
  OrganizedCloud measured =
      select_rows(unproject(kTenMetres, sensor, CaptureTime::kRolling), kMeasuredRows);
  for (float& time_s : measured.time_offset_s) time_s = std::remainder(time_s + 0.03F, 0.1F);
  const OrganizedCloud cloud = upsampled_cloud({kTenMetres, {}}, measured, kMeasuredRows, sensor);
  // Its neighbours fire last, at 46.9 ms, and 30 ms later is -23.1; row 2 is at the first column.
  CHECK(cloud.time_offset_s[cloud.index(2, 15)] == doctest::Approx(-0.046875 + 0.03));
}

TEST_CASE("a computed point is as late as the nearer one of the rows above and below") {
  constexpr RowSelection kEveryThird = {1, 3};  // rows 1 and 4
  const OrganizedCloud model = unproject(kTenMetres, kSixRows, CaptureTime::kRolling);
  OrganizedCloud measured = select_rows(model, kEveryThird);
  constexpr std::size_t kColumn = 8;
  measured.time_offset_s[kColumn] += 0.01F;
  measured.time_offset_s[16 + kColumn] += 0.02F;
  const OrganizedCloud cloud = upsampled_cloud({kTenMetres, {}}, measured, kEveryThird, kSixRows);
  const auto late_s = [&](int row) {
    const std::size_t pixel = cloud.index(row, kColumn);
    return cloud.time_offset_s[pixel] - model.time_offset_s[pixel];
  };
  CHECK(late_s(2) == doctest::Approx(0.01).epsilon(1e-4));
  CHECK(late_s(3) == doctest::Approx(0.02).epsilon(1e-4));
}

}  // namespace hqslam::nn
