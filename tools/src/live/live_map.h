#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace hqslam::tools {

/// Points to look at, as many as memory and a browser can bear: one per voxel, and when they become
/// too many one per voxel of twice the size.
class LiveMap {
 public:
  static constexpr std::size_t kMostPoints = 60'000;
  static constexpr float kFirstVoxel_m = 0.25F;

  /// Points that are not finite or beyond 50 km are left out.
  void add(const Eigen::Vector3f& point_m);
  void clear();

  /// Only grows, as long as the generation stays the same.
  const std::vector<Eigen::Vector3f>& points_m() const { return points_m_; }
  std::int64_t generation() const { return generation_; }
  float voxel_m() const { return voxel_m_; }

 private:
  bool take_voxel(const Eigen::Vector3f& point_m);
  void coarsen();

  float voxel_m_ = kFirstVoxel_m;
  std::int64_t generation_ = 0;
  std::vector<Eigen::Vector3f> points_m_;
  std::unordered_set<std::uint64_t> taken_;
};

}  // namespace hqslam::tools
