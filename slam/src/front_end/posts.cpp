#include "front_end/posts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "front_end/scattered_returns.h"

namespace hqslam::slam {

namespace {

constexpr float kPostDepth_m = 0.3F;
constexpr float kMaxWidth_m = 1.0F;  // chosen on simulated drives alone
constexpr float kMiddleBehindMean = std::numbers::pi_v<float> / 8.0F;  // of the width
/// Width of a beam: HDL-64E 2 mrad, VLP-16 and OS1 3 mrad (data sheets).
constexpr float kBeam_rad = 0.003F;
/// So many columns without a return have the sky behind them, where returns fail and where not:
/// with four everywhere the real handheld OS0 is less accurate.
constexpr int kGapWhereReturnsFail = 4;
constexpr int kGap = 1;

/// One row of a scan.
struct PostRow {
  const OrganizedCloud& cloud;
  const Segmentation& segmentation;
  int row;
  bool returns_fail;

  std::size_t pixel(int column) const { return cloud.index(row, column); }
  float range_m(int column) const { return cloud.range_m[pixel(column)]; }
  bool stands(int column) const {
    return segmentation.pixel_class[pixel(column)] == PixelClass::kObject;
  }
  /// The last column of the run that begins at `first`.
  int end_of_run(int first) const {
    int last = first;
    while (last + 1 < cloud.columns && stands(last + 1) &&
           std::abs(range_m(last + 1) - range_m(last)) <= kPostDepth_m) {
      ++last;
    }
    return last;
  }
  /// Whether the first return beside an object at range_m_, from `column` on in steps of `step`, is
  /// behind it, or there is none near by.
  bool goes_on_behind(int column, int step, float range_m_) const {
    const int gap = returns_fail ? kGapWhereReturnsFail : kGap;
    const int end = std::clamp(column + step * gap, -1, cloud.columns);
    while (column != end && !(range_m(column) > 0.0F)) column += step;
    return column == end || range_m(column) > range_m_ + kPostDepth_m;
  }
  bool stands_alone(int first, int last) const {
    return first > 0 && last + 1 < cloud.columns && goes_on_behind(first - 1, -1, range_m(first)) &&
           goes_on_behind(last + 1, 1, range_m(last));
  }
  /// Whether it is near, and neither the row above nor the one below meets it, too.
  bool may_be_echo(int first, int last) const {
    if (!returns_fail || range_m(first) > kFarthestEcho_m) return false;
    for (const int other : {row - 1, row + 1}) {
      if (other < 0 || other >= cloud.rows) continue;
      for (int column = first - 1; column <= last + 1; ++column) {
        const float other_m = cloud.range_m[cloud.index(other, column)];
        if (other_m > 0.0F && std::abs(other_m - range_m(first)) <= kPostDepth_m) return false;
      }
    }
    return true;
  }
  float width_m(int first, int last) const {
    return (cloud.points_m[pixel(last)] - cloud.points_m[pixel(first)]).norm();
  }
  FeaturePoint centre(int first, int last) const {
    Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();
    for (int column = first; column <= last; ++column) sum_m += cloud.points_m[pixel(column)];
    const bool timed = !cloud.time_offset_s.empty();
    const float time_s = timed ? cloud.time_offset_s[pixel((first + last) / 2)] : 0.0F;
    const Eigen::Vector3f mean_m = sum_m / static_cast<float>(last - first + 1);
    const float column_rad = 2.0F * std::numbers::pi_v<float> / static_cast<float>(cloud.columns);
    const float beyond_m = (column_rad - kBeam_rad) * mean_m.norm();  // the outer points
    const float object_m = std::max(width_m(first, last) + beyond_m, 0.0F);
    FeaturePoint centre{mean_m + kMiddleBehindMean * object_m * mean_m.normalized(), time_s, row};
    if (!cloud.intensity.empty()) centre.intensity = cloud.intensity[pixel((first + last) / 2)];
    return centre;
  }
};

}  // namespace

std::vector<Post> posts_in_row(const OrganizedCloud& cloud, const Segmentation& segmentation,
                               int row, bool returns_fail) {
  const PostRow in{cloud, segmentation, row, returns_fail};
  std::vector<Post> posts;
  for (int first = 0; first < cloud.columns;) {
    if (!in.stands(first)) {
      ++first;
      continue;
    }
    const int last = in.end_of_run(first);
    const bool is_narrow = in.stands_alone(first, last) && in.width_m(first, last) <= kMaxWidth_m;
    if (is_narrow && !in.may_be_echo(first, last)) {
      posts.push_back({in.centre(first, last), first, last});
    }
    first = last + 1;
  }
  return posts;
}

}  // namespace hqslam::slam
