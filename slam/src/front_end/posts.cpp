#include "front_end/posts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hqslam::slam {

namespace {

constexpr float kPostDepth_m = 0.3F;
constexpr float kMiddleBehindMean = std::numbers::pi_v<float> / 8.0F;  // of the width
/// Width of a beam: HDL-64E 2 mrad, VLP-16 and OS1 3 mrad (data sheets).
constexpr float kBeam_rad = 0.003F;

/// One row of a scan.
struct PostRow {
  const OrganizedCloud& cloud;
  const Segmentation& segmentation;
  int row;

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
  /// Whether the row has nothing at `column`, or something behind an object at range_m_.
  bool goes_on_behind(int column, float range_m_) const {
    return !(range_m(column) > 0.0F) || range_m(column) > range_m_ + kPostDepth_m;
  }
  bool stands_alone(int first, int last) const {
    return first > 0 && last + 1 < cloud.columns && goes_on_behind(first - 1, range_m(first)) &&
           goes_on_behind(last + 1, range_m(last));
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
                               int row, double max_width_m) {
  const PostRow in{cloud, segmentation, row};
  std::vector<Post> posts;
  for (int first = 0; first < cloud.columns;) {
    if (!in.stands(first)) {
      ++first;
      continue;
    }
    const int last = in.end_of_run(first);
    if (in.stands_alone(first, last) && in.width_m(first, last) <= max_width_m) {
      posts.push_back({in.centre(first, last), first, last});
    }
    first = last + 1;
  }
  return posts;
}

}  // namespace hqslam::slam
