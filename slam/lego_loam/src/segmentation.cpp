#include "segmentation.h"

#include <cmath>

#include "hqslam/core/angles.h"
#include "hqslam/lego_loam/lego_loam.h"

namespace hqslam::lego_loam {

namespace {

constexpr float kMinRange_m = 1.0F;
constexpr float kMaxRange_m = 1000.0F;  // what a LiDAR may measure
constexpr double kMaxGroundSlope_deg = 10.0;
constexpr double kMinClusterAngle_deg = 60.0;
constexpr int kMinPoints = 30;
constexpr int kMinPointsTall = 5;
constexpr int kMinRowsTall = 3;
constexpr int kKeptColumn = 5;  // of the ground and of outliers
constexpr int kSeam = 5;        // columns at the image's ends whose ground is kept

/// The lowest rows pairs of which are searched for ground, less one: the program's presets, for
/// other sensors as large a share as theirs are.
int ground_rows(int rows) {
  switch (rows) {
    case 16:
      return 7;
    case 32:
      return 20;
    case 64:
      return 15;
    case 128:
      return 10;
    default:
      return rows / 3;
  }
}

RangeImage usable_ranges(const OrganizedCloud& cloud) {
  RangeImage image = range_image(cloud);
  for (std::size_t pixel = 0; pixel < image.range_m.size(); ++pixel) {
    const float range_m = image.range_m[pixel];
    const bool usable = range_m >= kMinRange_m && range_m <= kMaxRange_m &&
                        cloud.points_m[pixel].cwiseAbs().maxCoeff() <= kMaxRange_m;
    if (!usable) image.range_m[pixel] = 0.0F;
  }
  return image;
}

bool is_kept(const Component& cluster) {
  return cluster.pixels >= kMinPoints || (cluster.pixels >= kMinPointsTall &&
                                          cluster.last_row - cluster.first_row + 1 >= kMinRowsTall);
}

bool is_kept_ground(int column, int columns) {
  return column % kKeptColumn == 0 || column <= kSeam || column >= columns - kSeam;
}

/// Per pixel as in ScanTrace; clusters that are kept are numbered in the order of their first
/// pixel.
std::vector<std::int32_t> labels_of(const RangeImage& image,
                                    const std::vector<std::uint8_t>& ground,
                                    const ConnectedComponents& connected, int& clusters) {
  std::vector<std::int32_t> number;
  for (const Component& cluster : connected.components) {
    number.push_back(is_kept(cluster) ? ++clusters : ScanTrace::kOutlier);
  }
  std::vector<std::int32_t> label(image.range_m.size(), ScanTrace::kNoReturn);
  for (std::size_t pixel = 0; pixel < label.size(); ++pixel) {
    if (ground[pixel] != 0) label[pixel] = ScanTrace::kGround;
    if (connected.label[pixel] >= 0) label[pixel] = number[connected.label[pixel]];
  }
  return label;
}

}  // namespace

Segmentation::Segmentation(const SensorModel& sensor)
    : scan_period_s_(sensor.scan_period_s),
      ground_rows_(ground_rows(sensor.rows())),
      labeler_(sensor, {radians(kMinClusterAngle_deg), true}) {}

std::vector<std::uint8_t> Segmentation::ground_of(const OrganizedCloud& cloud,
                                                  const RangeImage& image) const {
  std::vector<std::uint8_t> ground(image.range_m.size(), 0);
  for (int lower_row = image.rows - 1; lower_row >= image.rows - ground_rows_; --lower_row) {
    for (int column = 0; column < image.columns; ++column) {
      const std::size_t lower = image.index(lower_row, column);
      const std::size_t upper = image.index(lower_row - 1, column);
      if (image.range_m[lower] <= 0.0F || image.range_m[upper] <= 0.0F) continue;
      const Eigen::Vector3f step_m = cloud.points_m[upper] - cloud.points_m[lower];
      const double slope_rad = std::atan2(step_m.z(), step_m.head<2>().norm());
      if (degrees(std::abs(slope_rad)) <= kMaxGroundSlope_deg) ground[lower] = ground[upper] = 1;
    }
  }
  return ground;
}

SegmentedScan Segmentation::segment(const OrganizedCloud& cloud) {
  const RangeImage image = usable_ranges(cloud);
  const std::vector<std::uint8_t> ground = ground_of(cloud, image);
  SegmentedScan scan;
  scan.label = labels_of(image, ground, labeler_.label(image, ground), scan.clusters);
  scan.rows.resize(image.rows);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const std::size_t pixel = image.index(row, column);
      const std::int32_t label = scan.label[pixel];
      if (label == ScanTrace::kNoReturn) continue;
      // A scan without times is captured in one moment: the end of the sweep.
      const double fraction =
          cloud.time_offset_s.empty() ? 1.0 : 0.5 + cloud.time_offset_s[pixel] / scan_period_s_;
      const Point point = point_of(cloud.points_m[pixel], row, static_cast<float>(fraction));
      if (label == ScanTrace::kGround) {
        ++scan.ground_points;
        if (!is_kept_ground(column, image.columns)) continue;
      } else if (label == ScanTrace::kOutlier) {
        const bool above_ground_rows = row < image.rows - 1 - ground_rows_;
        if (above_ground_rows && column % kKeptColumn == 0) scan.outliers.push_back(point);
        continue;
      }
      scan.rows[row].push_back({point, image.range_m[pixel], column, label == ScanTrace::kGround});
    }
  }
  return scan;
}

}  // namespace hqslam::lego_loam
