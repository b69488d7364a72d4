#include "hqslam/evaluation/cloud_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "hqslam/core/error.h"
#include "nearest_point.h"

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
