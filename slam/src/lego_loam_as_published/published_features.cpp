#include "published_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "front_end/voxel_thinning.h"
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

constexpr int kSections = 6;
constexpr int kNeighbours = 5;
constexpr int kAdjacentColumns = 10;
constexpr int kSharpPerSection = 2;
constexpr int kLessSharpPerSection = 20;
constexpr int kFlatPerSection = 4;
constexpr float kThreshold_m2 = 0.1F;
constexpr float kDepthJump_m = 0.3F;
constexpr float kParallelShare = 0.02F;
constexpr double kLessFlatLeaf_m = 0.2;

class Selection {
 public:
  explicit Selection(const SegmentedScan& scan)
      : scan_(scan),
        count_(static_cast<int>(scan.points.size())),
        smoothness_m2_(scan.points.size(), 0.0F),
        passed_over_(scan.points.size(), 0),
        is_edge_(scan.points.size(), 0),
        order_(scan.points.size()) {
    for (int i = 0; i < count_; ++i) order_[i] = i;
    find_smoothness();
    mark_occluded();
  }

  PublishedFeatures choose() {
    for (std::size_t row = 0; row < scan_.first.size(); ++row) {
      std::vector<FeaturePoint> less_flat;
      for (int section = 0; section < kSections; ++section) {
        const int first =
            (scan_.first[row] * (kSections - section) + scan_.last[row] * section) / kSections;
        const int last =
            (scan_.first[row] * (kSections - 1 - section) + scan_.last[row] * (section + 1)) /
                kSections -
            1;
        if (first >= last || first < 0) continue;
        choose_in_section(first, last, less_flat);
      }
      const std::vector<FeaturePoint> thinned = thin(less_flat, kLessFlatLeaf_m);
      features_.less_flat.insert(features_.less_flat.end(), thinned.begin(), thinned.end());
    }
    return std::move(features_);
  }

 private:
  void find_smoothness() {
    for (int i = kNeighbours; i < count_ - kNeighbours; ++i) {
      float sum_m = -2.0F * kNeighbours * scan_.points[i].range_m;
      for (int j = 1; j <= kNeighbours; ++j) {
        sum_m += scan_.points[i - j].range_m + scan_.points[i + j].range_m;
      }
      smoothness_m2_[i] = sum_m * sum_m;
    }
  }

  void mark_occluded() {
    for (int i = kNeighbours; i < count_ - kNeighbours - 1; ++i) {
      const float range_m = scan_.points[i].range_m;
      const float next_m = scan_.points[i + 1].range_m;
      if (std::abs(scan_.points[i + 1].column - scan_.points[i].column) < kAdjacentColumns) {
        if (range_m - next_m > kDepthJump_m) {
          for (int j = i - kNeighbours; j <= i; ++j) passed_over_[j] = 1;
        } else if (next_m - range_m > kDepthJump_m) {
          for (int j = i + 1; j <= std::min(i + 1 + kNeighbours, count_ - 1); ++j) {
            passed_over_[j] = 1;
          }
        }
      }
      const float before_m = scan_.points[i - 1].range_m;
      if (std::abs(before_m - range_m) > kParallelShare * range_m &&
          std::abs(next_m - range_m) > kParallelShare * range_m) {
        passed_over_[i] = 1;
      }
    }
  }

  void choose_in_section(int first, int last, std::vector<FeaturePoint>& less_flat) {
    std::sort(order_.begin() + first, order_.begin() + last,
              [&](int a, int b) { return smoothness_m2_[a] < smoothness_m2_[b]; });
    choose_edges(first, last);
    choose_flat(first, last);
    for (int i = first; i <= last; ++i) {
      if (is_edge_[i] == 0) less_flat.push_back(scan_.points[i].point);
    }
  }

  void choose_edges(int first, int last) {
    int chosen = 0;
    for (int k = last; k >= first && chosen < kLessSharpPerSection; --k) {
      const int i = order_[k];
      if (passed_over_[i] != 0 || scan_.points[i].ground || smoothness_m2_[i] <= kThreshold_m2) {
        continue;
      }
      ++chosen;
      is_edge_[i] = 1;
      if (chosen <= kSharpPerSection) features_.sharp.push_back(scan_.points[i].point);
      features_.less_sharp.push_back(scan_.points[i].point);
      pass_over_neighbours(i);
    }
  }

  void choose_flat(int first, int last) {
    int chosen = 0;
    for (int k = first; k <= last; ++k) {
      const int i = order_[k];
      if (passed_over_[i] != 0 || !scan_.points[i].ground || smoothness_m2_[i] >= kThreshold_m2) {
        continue;
      }
      features_.flat.push_back(scan_.points[i].point);
      if (++chosen == kFlatPerSection) return;
      pass_over_neighbours(i);
    }
  }

  void pass_over_neighbours(int i) {
    passed_over_[i] = 1;
    for (const int direction : {1, -1}) {
      for (int j = 1; j <= kNeighbours; ++j) {
        const int at = i + direction * j;
        if (at < 0 || at >= count_) break;
        const int gap = scan_.points[at].column - scan_.points[at - direction].column;
        if (std::abs(gap) > kAdjacentColumns) break;
        passed_over_[at] = 1;
      }
    }
  }

  const SegmentedScan& scan_;
  int count_;
  std::vector<float> smoothness_m2_;
  std::vector<std::uint8_t> passed_over_;
  std::vector<std::uint8_t> is_edge_;
  std::vector<int> order_;
  PublishedFeatures features_;
};

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

PublishedFeatures published_features(const SegmentedScan& scan) { return Selection(scan).choose(); }

}  // namespace hqslam::slam::as_published
