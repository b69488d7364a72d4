#include "hqslam/evaluation/cloud_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam {

namespace {

using Points = std::vector<Eigen::Vector3f>;
using Voxel = std::array<std::int64_t, 3>;

/// No map is wider; keeps voxel indices and squared distances within their types.
constexpr float kMaxCoordinate_m = 1e7F;

constexpr std::array<double CloudError::*, 6> kFigures = {
    &CloudError::iou, &CloudError::precision,  &CloudError::recall,
    &CloudError::f1,  &CloudError::chamfer_m2, &CloudError::outlier_share};

void require_points(const Points& points_m, const std::string& which) {
  if (points_m.empty()) {
    throw Error("{}: expected at least one point, found none", which);
  }
  for (const Eigen::Vector3f& p : points_m) {
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kMaxCoordinate_m) {
      throw Error("{}: expected finite coordinates below {} m, found {} {} {}", which,
                  kMaxCoordinate_m, p.x(), p.y(), p.z());
    }
  }
}

/// Ranges of so few points are searched one by one.
constexpr std::size_t kLeafPoints = 12;

/// Exact nearest neighbours in a fixed set of points: a balanced k-d tree.
class NearestPoint {
 public:
  /// At least one point; all finite.
  explicit NearestPoint(std::vector<Eigen::Vector3f> points_m)
      : points_m_(std::move(points_m)), axis_(points_m_.size(), 0) {
    build(0, points_m_.size());
  }

  /// Squared distance to the nearest point, square metres.
  double squared_distance_m2(const Eigen::Vector3f& query_m) const {
    float nearest_m2 = std::numeric_limits<float>::infinity();
    search(0, points_m_.size(), query_m, nearest_m2);
    return nearest_m2;
  }

 private:
  void build(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeafPoints) return;
    Eigen::Vector3f lowest = points_m_[begin];
    Eigen::Vector3f highest = points_m_[begin];
    for (std::size_t i = begin; i < end; ++i) {
      lowest = lowest.cwiseMin(points_m_[i]);
      highest = highest.cwiseMax(points_m_[i]);
    }
    int axis = 0;
    (highest - lowest).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) {
      return points_m_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(
        at(begin), at(middle), at(end),
        [axis](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a[axis] < b[axis]; });
    axis_[middle] = static_cast<std::uint8_t>(axis);
    build(begin, middle);
    build(middle + 1, end);
  }

  void search(std::size_t begin, std::size_t end, const Eigen::Vector3f& query_m,
              float& nearest_m2) const {
    if (end - begin <= kLeafPoints) {
      for (std::size_t i = begin; i < end; ++i) {
        nearest_m2 = std::min(nearest_m2, (points_m_[i] - query_m).squaredNorm());
      }
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    nearest_m2 = std::min(nearest_m2, (points_m_[middle] - query_m).squaredNorm());
    const float beyond_m = query_m[axis_[middle]] - points_m_[middle][axis_[middle]];
    const bool before = beyond_m < 0.0F;
    before ? search(begin, middle, query_m, nearest_m2)
           : search(middle + 1, end, query_m, nearest_m2);
    if (beyond_m * beyond_m >= nearest_m2) return;
    before ? search(middle + 1, end, query_m, nearest_m2)
           : search(begin, middle, query_m, nearest_m2);
  }

  /// Of each range of points, the middle one splits the rest along axis_[middle]: what is before
  /// it is not beyond it, what is behind it is not before it. The halves are split likewise.
  std::vector<Eigen::Vector3f> points_m_;
  std::vector<std::uint8_t> axis_;
};

struct Distances {
  double mean_squared_m2 = 0.0;
  double outlier_share = 0.0;
};

Distances distances(const Points& from_m, const Points& to_m) {
  const NearestPoint nearest(to_m);
  Distances result;
  const double n = static_cast<double>(from_m.size());
  std::size_t outliers = 0;
  for (const Eigen::Vector3f& point_m : from_m) {
    const double squared_m2 = nearest.squared_distance_m2(point_m);
    result.mean_squared_m2 += squared_m2 / n;
    outliers += squared_m2 > kOutlierDistance_m * kOutlierDistance_m ? 1 : 0;
  }
  result.outlier_share = static_cast<double>(outliers) / n;
  return result;
}

Eigen::Vector3d lowest_corner(const Points& a_m, const Points& b_m) {
  Eigen::Vector3f lowest = a_m.front();
  for (const Points* points_m : {&a_m, &b_m}) {
    for (const Eigen::Vector3f& point_m : *points_m) lowest = lowest.cwiseMin(point_m);
  }
  return lowest.cast<double>();
}

/// The occupied voxels, each once, sorted.
std::vector<Voxel> voxels(const Points& points_m, const Eigen::Vector3d& origin_m) {
  std::vector<Voxel> result;
  result.reserve(points_m.size());
  for (const Eigen::Vector3f& point_m : points_m) {
    const Eigen::Vector3d index = (point_m.cast<double>() - origin_m) / kCloudErrorVoxel_m;
    result.push_back({static_cast<std::int64_t>(std::floor(index.x())),
                      static_cast<std::int64_t>(std::floor(index.y())),
                      static_cast<std::int64_t>(std::floor(index.z()))});
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::size_t common_count(const std::vector<Voxel>& a, const std::vector<Voxel>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    count += a[i] == b[j] ? 1 : 0;
    const bool advance_a = a[i] <= b[j];
    const bool advance_b = b[j] <= a[i];
    i += advance_a ? 1 : 0;
    j += advance_b ? 1 : 0;
  }
  return count;
}

}  // namespace

CloudError cloud_error(const Points& cloud_m, const Points& true_cloud_m) {
  CloudError error{voxel_overlap(cloud_m, true_cloud_m)};
  const Distances to_true = distances(cloud_m, true_cloud_m);
  error.chamfer_m2 = to_true.mean_squared_m2 + distances(true_cloud_m, cloud_m).mean_squared_m2;
  error.outlier_share = to_true.outlier_share;
  return error;
}

CloudError& operator+=(CloudError& sum, const CloudError& error) {
  for (const auto figure : kFigures) sum.*figure += error.*figure;
  return sum;
}

CloudError& operator/=(CloudError& sum, double clouds) {
  for (const auto figure : kFigures) sum.*figure /= clouds;
  return sum;
}

VoxelOverlap voxel_overlap(const Points& cloud_m, const Points& true_cloud_m) {
  require_points(cloud_m, "cloud");
  require_points(true_cloud_m, "true cloud");
  const Eigen::Vector3d origin_m = lowest_corner(cloud_m, true_cloud_m);
  const std::vector<Voxel> occupied = voxels(cloud_m, origin_m);
  const std::vector<Voxel> truly_occupied = voxels(true_cloud_m, origin_m);
  const double both = static_cast<double>(common_count(occupied, truly_occupied));
  const double in_cloud = static_cast<double>(occupied.size());
  const double in_true = static_cast<double>(truly_occupied.size());
  return {.iou = both / (in_cloud + in_true - both),
          .precision = both / in_cloud,
          .recall = both / in_true,
          .f1 = 2.0 * both / (in_cloud + in_true)};
}

std::vector<float> nearest_distances_m(const std::vector<Eigen::Vector3f>& cloud_m,
                                       const std::vector<Eigen::Vector3f>& true_cloud_m) {
  require_points(cloud_m, "cloud");
  require_points(true_cloud_m, "true cloud");
  const NearestPoint nearest(true_cloud_m);
  std::vector<float> distances_m;
  distances_m.reserve(cloud_m.size());
  for (const Eigen::Vector3f& point_m : cloud_m) {
    distances_m.push_back(static_cast<float>(std::sqrt(nearest.squared_distance_m2(point_m))));
  }
  return distances_m;
}

}  // namespace hqslam
