#include "hqslam/core/error.h"
#include "hqslam/core/point_columns.h"
#include "hqslam/slam/dense_map.h"

namespace hqslam::slam {

void write_dense_map(const std::vector<DenseMapPoint>& points, const std::string& path,
                     const std::vector<float>& intensity) {
  if (!intensity.empty() && intensity.size() != points.size()) {
    throw Error("{}: expected {} intensities, one per point, found {}", path, points.size(),
                intensity.size());
  }
  const DenseMapPoint none;
  const DenseMapPoint& first = points.empty() ? none : points.front();
  constexpr std::size_t kStep = sizeof(DenseMapPoint);
  std::vector<PointColumn> columns = {{"x", {'F', 4}, &first.point_m.x(), kStep},
                                      {"y", {'F', 4}, &first.point_m.y(), kStep},
                                      {"z", {'F', 4}, &first.point_m.z(), kStep}};
  if (!intensity.empty()) {
    columns.push_back({"intensity", {'F', 4}, intensity.data(), sizeof(float)});
  }
  columns.push_back({"confidence", {'F', 4}, &first.confidence, kStep});
  columns.push_back({"times_seen", {'U', 4}, &first.times_seen, kStep});
  write_points(columns, points.size(), path, "written by hqslam");
}

}  // namespace hqslam::slam
