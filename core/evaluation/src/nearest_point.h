#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hqslam {

/// Exact nearest neighbours in a fixed set of points: a balanced k-d tree.
class NearestPoint {
 public:
  /// At least one point; all finite.
  explicit NearestPoint(std::vector<Eigen::Vector3f> points_m);

  /// Squared distance to the nearest point, square metres.
  double squared_distance_m2(const Eigen::Vector3f& query_m) const;

 private:
  void build(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, const Eigen::Vector3f& query_m,
              float& nearest_m2) const;

  /// A tree in place: the middle point of each range splits it along axis_[middle]. No point before
  /// the middle has a larger coordinate on that axis, no point behind it a smaller one.
  std::vector<Eigen::Vector3f> points_m_;
  std::vector<std::uint8_t> axis_;
};

}  // namespace hqslam
