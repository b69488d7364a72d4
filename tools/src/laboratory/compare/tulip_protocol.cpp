#include "laboratory/compare/tulip_protocol.h"

#include <cmath>
#include <numbers>

#include "hqslam/evaluation/image_error.h"

namespace hqslam::tools {
namespace {

constexpr int kRows = 64;
constexpr int kColumns = 1024;
constexpr int kMeasuredRows = 16;
constexpr double kLowest_deg = -24.8;
constexpr double kRowStep_deg = 26.8 / (kRows - 1);
constexpr double kColumnStep_deg = 360.0 / kColumns;
constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kMaxRange_m = 120.0;
constexpr float kMinPrediction_m = 2.0F;
constexpr float kMaxPrediction_m = 80.0F;

/// TULIP's column of ours and ours of TULIP's: the circle turned over, forward stays at 512.
int mirrored(int column) { return (kColumns - column) % kColumns; }

bool is_measured(int row) { return selection_for(kRows, kMeasuredRows).contains(row); }

double mae_of_computed_rows_m(const RangeImage& image, const RangeImage& truth) {
  double sum_m = 0.0;
  for (int row = 0; row < kRows; ++row) {
    if (is_measured(row)) continue;
    for (int column = 0; column < kColumns; ++column) {
      sum_m += std::abs(image.at(row, column) - truth.at(row, column));
    }
  }
  return sum_m / ((kRows - kMeasuredRows) * kColumns);
}

}  // namespace

SensorModel tulip_sensor() {
  SensorModel sensor;
  sensor.name = "tulip-kitti";
  sensor.columns = kColumns;
  sensor.max_range_m = kMaxRange_m;
  for (int row = 0; row < kRows; ++row) {
    sensor.beam_elevation_rad.push_back((kLowest_deg + kRowStep_deg * (kRows - 1 - row)) *
                                        kDegree_rad);
    sensor.beam_azimuth_offset_rad.push_back(0.0);
  }
  return sensor;
}

RangeImage tulip_image(const std::vector<Eigen::Vector3f>& points_m) {
  RangeImage image(kRows, kColumns);
  for (const Eigen::Vector3f& p : points_m) {
    const double range_m = p.cast<double>().norm();
    const double elevation_deg = std::atan2(p.z(), std::hypot(p.x(), p.y())) / kDegree_rad;
    const double from_below = std::round((elevation_deg - kLowest_deg) / kRowStep_deg);
    if (!(from_below >= 0.0 && from_below < kRows)) continue;
    const double azimuth_deg = std::atan2(p.x(), p.y()) / kDegree_rad;
    const int column = kColumns / 2 - static_cast<int>((azimuth_deg - 90.0) / kColumnStep_deg);
    const int wrapped = (column % kColumns + kColumns) % kColumns;
    image.at(kRows - 1 - static_cast<int>(from_below), mirrored(wrapped)) =
        range_m > kMaxRange_m ? 0.0F : static_cast<float>(range_m);
  }
  return image;
}

std::vector<Eigen::Vector3f> tulip_points_m(const RangeImage& image) {
  std::vector<Eigen::Vector3f> points_m;
  points_m.reserve(image.range_m.size());
  for (int row = 0; row < image.rows; ++row) {
    const double elevation_rad = (kLowest_deg + kRowStep_deg * (kRows - 1 - row)) * kDegree_rad;
    for (int column = 0; column < image.columns; ++column) {
      const int from_ahead = kColumns / 2 - (mirrored(column) + 1);
      const double azimuth_rad = (90.0 + from_ahead * kColumnStep_deg) * kDegree_rad;
      const double range_m = image.at(row, column);
      points_m.emplace_back(
          static_cast<float>(range_m * std::cos(elevation_rad) * std::sin(azimuth_rad)),
          static_cast<float>(range_m * std::cos(elevation_rad) * std::cos(azimuth_rad)),
          static_cast<float>(range_m * std::sin(elevation_rad)));
    }
  }
  return points_m;
}

TulipScore tulip_score(RangeImage lifted, const RangeImage& truth) {
  for (float& range_m : lifted.range_m) {
    if (!(range_m >= kMinPrediction_m && range_m <= kMaxPrediction_m)) range_m = 0.0F;
  }
  TulipScore score;
  score.mae_m = image_error(lifted, truth).mae_all_m;
  score.mae_computed_m = mae_of_computed_rows_m(lifted, truth);
  for (int row = 0; row < kRows; ++row) {
    if (!is_measured(row)) continue;
    for (int column = 0; column < kColumns; ++column) {
      lifted.at(row, column) = truth.at(row, column);
    }
  }
  static_cast<CloudError&>(score) = cloud_error(tulip_points_m(lifted), tulip_points_m(truth));
  return score;
}

}  // namespace hqslam::tools
