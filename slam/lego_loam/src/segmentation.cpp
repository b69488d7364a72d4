#include "segmentation.h"

#include <algorithm>
#include <cmath>
#include <map>

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

/// How many pairs of rows are searched for ground: the program's presets, for other sensors as
/// large a share as theirs are.
int ground_rows(int rows) {
  const std::map<int, int> presets = {{16, 7}, {32, 20}, {64, 15}, {128, 10}};
  const auto preset = presets.find(rows);
  return preset != presets.end() ? preset->second : rows / 3;
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

std::vector<std::uint8_t> ground_of(const OrganizedCloud& cloud, const RangeImage& image,
                                    int pairs) {
  std::vector<std::uint8_t> ground(image.range_m.size(), 0);
  for (int lower_row = image.rows - 1; lower_row >= image.rows - pairs; --lower_row) {
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

}  // namespace

Segmentation::Segmentation(const SensorModel& sensor)
    : scan_period_s_(sensor.scan_period_s),
      ground_rows_(ground_rows(sensor.rows())),
      labeler_(sensor, radians(kMinClusterAngle_deg)) {}

SegmentedScan Segmentation::segment(const OrganizedCloud& cloud) {
  const RangeImage image = usable_ranges(cloud);
  const std::vector<std::uint8_t> ground = ground_of(cloud, image, ground_rows_);
  const ConnectedComponents& connected = labeler_.label(image, ground);
  SegmentedScan scan;
  std::vector<std::int32_t> cluster;
  for (const Component& component : connected.components) {
    cluster.push_back(is_kept(component) ? ++scan.clusters : ScanTrace::kOutlier);
  }
  scan.label.assign(ground.size(), ScanTrace::kNoReturn);
  scan.rows.resize(image.rows);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const std::size_t pixel = image.index(row, column);
      if (image.range_m[pixel] <= 0.0F) continue;
      std::int32_t& label = scan.label[pixel];
      label = ground[pixel] != 0 ? ScanTrace::kGround : cluster[connected.label[pixel]];
      // A scan without times is captured in one moment: the end of the sweep.
      const double fraction =
          cloud.time_offset_s.empty() ? 1.0 : 0.5 + cloud.time_offset_s[pixel] / scan_period_s_;
      const Point point = point_of(cloud.points_m[pixel], row, fraction);
      const bool in_kept_column = column % kKeptColumn == 0;
      if (label == ScanTrace::kOutlier) {
        const bool above_ground_rows = row < image.rows - 1 - ground_rows_;
        if (above_ground_rows && in_kept_column) scan.outliers.push_back(point);
      } else if (label > ScanTrace::kGround || in_kept_column || column <= kSeam ||
                 column >= image.columns - kSeam) {
        scan.rows[row].push_back({point, image.range_m[pixel], column, ground[pixel] != 0});
      }
    }
  }
  scan.ground_points = static_cast<int>(std::ranges::count(ground, 1));
  return scan;
}

}  // namespace hqslam::lego_loam
