#include "segmented_scan.h"

#include <cmath>
#include <cstdint>

#include "hqslam/slam/options.h"

namespace hqslam::slam::as_published {

namespace {

constexpr float kMinRange_m = 1.0F;
constexpr int kMinPixels = 30;
constexpr int kMinPixelsTall = 5;
constexpr int kMinRowsTall = 3;
constexpr int kKeptColumn = 5;  ///< of the ground and of outliers
constexpr int kRowMargin = 5;

/// The index up to which pairs of rows are searched for ground, counted from the lowest: the
/// published presets; for other sensors about as large a share as theirs.
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

/// The image's row of the program's.
int image_row(const OrganizedCloud& cloud, int row) { return cloud.rows - 1 - row; }

bool has_return(const OrganizedCloud& cloud, std::size_t pixel) {
  return cloud.range_m[pixel] >= kMinRange_m;
}

std::vector<std::uint8_t> ground_of(const OrganizedCloud& cloud, int rows) {
  const auto max_slope_rad = static_cast<float>(GroundOptions().max_slope_rad);
  std::vector<std::uint8_t> ground(cloud.range_m.size(), 0);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t lower = cloud.index(image_row(cloud, row), column);
      const std::size_t upper = cloud.index(image_row(cloud, row + 1), column);
      if (!has_return(cloud, lower) || !has_return(cloud, upper)) continue;
      const Eigen::Vector3f step_m = cloud.points_m[upper] - cloud.points_m[lower];
      const float slope_rad = std::atan2(step_m.z(), step_m.head<2>().norm());
      if (std::abs(slope_rad) <= max_slope_rad) ground[lower] = ground[upper] = 1;
    }
  }
  return ground;
}

/// Whether a component is kept, one value each. The program starts a component at its first point
/// from below and forgets to count the row of that point.
std::vector<std::uint8_t> kept_components(const OrganizedCloud& cloud,
                                          const ConnectedComponents& connected) {
  std::vector<std::uint8_t> started(connected.components.size(), 0);
  std::vector<int> last_counted_row(connected.components.size(), -1);
  std::vector<int> rows(connected.components.size(), 0);
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const std::int32_t label = connected.label[cloud.index(image_row(cloud, row), column)];
      if (label == ConnectedComponents::kNoComponent) continue;
      if (started[label] == 0) {
        started[label] = 1;
      } else if (last_counted_row[label] != row) {
        last_counted_row[label] = row;
        ++rows[label];
      }
    }
  }
  std::vector<std::uint8_t> kept;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int pixels = connected.components[i].pixels;
    kept.push_back(pixels >= kMinPixels || (pixels >= kMinPixelsTall && rows[i] >= kMinRowsTall));
  }
  return kept;
}

bool is_kept_ground(int column, int columns) {
  return column % kKeptColumn == 0 || column <= kRowMargin || column >= columns - kRowMargin;
}

}  // namespace

ImageProjection::ImageProjection(const SensorModel& sensor)
    : sensor_(sensor),
      ground_rows_(ground_rows(sensor.rows())),
      labeler_(sensor, {SegmentationOptions().min_angle_rad, true}) {}

SegmentedScan ImageProjection::segment(const OrganizedCloud& cloud) {
  RangeImage image = range_image(cloud);
  for (float& range_m : image.range_m) range_m = range_m >= kMinRange_m ? range_m : 0.0F;
  const std::vector<std::uint8_t> ground = ground_of(cloud, ground_rows_);
  const ConnectedComponents& connected = labeler_.label(image, ground);
  const std::vector<std::uint8_t> kept = kept_components(cloud, connected);
  const auto sweep_end_s = static_cast<float>(0.5 * sensor_.scan_period_s);
  SegmentedScan scan;
  for (int row = 0; row < cloud.rows; ++row) {
    scan.first.push_back(static_cast<int>(scan.points.size()) - 1 + kRowMargin);
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t pixel = cloud.index(image_row(cloud, row), column);
      if (image.range_m[pixel] <= 0.0F) continue;
      // A scan without times is taken as captured in one moment, the end of the sweep.
      const float time_offset_s =
          cloud.time_offset_s.empty() ? sweep_end_s : cloud.time_offset_s[pixel];
      const FeaturePoint point{cloud.points_m[pixel], time_offset_s, row};
      if (ground[pixel] != 0) {
        if (!is_kept_ground(column, cloud.columns)) continue;
      } else if (kept[connected.label[pixel]] == 0) {
        if (row > ground_rows_ && column % kKeptColumn == 0) scan.outliers.push_back(point);
        continue;
      }
      scan.points.push_back({point, image.range_m[pixel], column, ground[pixel] != 0});
    }
    scan.last.push_back(static_cast<int>(scan.points.size()) - 1 - kRowMargin);
  }
  return scan;
}

}  // namespace hqslam::slam::as_published
