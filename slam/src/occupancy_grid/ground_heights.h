#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "occupancy_grid/cell_chunks.h"

namespace hqslam::slam {

/// Heights of the ground in the map frame, from points on it (OccupancyGrid).
class GroundHeights {
 public:
  static constexpr double kCell_m = 0.5;

  /// Whether a point is finite and within 1,000 km, so that its cell has a number.
  static bool is_near(const Eigen::Vector3d& point_m) {
    return (point_m.cwiseAbs().array() < kFarthest_m).all();
  }
  /// In: a point that is near.
  void add(const Eigen::Vector3d& point_m);
  /// Computes the lower envelope of all points.
  void settle();
  /// The height at a place, after `settle`; nothing where no ground is within reach.
  std::optional<double> at(const Eigen::Vector2d& place_m) const;
  /// Calls visit(square) for each square of kCell_m with a height.
  template <typename Visit>
  void for_each_known(const Visit& visit) const {
    heights_.for_each([&](const Eigen::Vector2i& cell, const Height& height) {
      const Eigen::Vector2d corner_m = kCell_m * cell.cast<double>();
      if (height.is_known) visit(Eigen::AlignedBox2d(corner_m, corner_m.array() + kCell_m));
    });
  }

 private:
  static constexpr double kFarthest_m = 1e6;
  /// Sums are integers, so that the order of the points does not matter.
  struct Sum {
    std::int64_t height_sum_mm = 0;
    std::uint32_t points = 0;
  };
  struct Height {
    bool is_known = false;
    float m = 0.0F;
  };
  static Eigen::Vector2i cell_of(const Eigen::Vector2d& place_m) {
    return (place_m / kCell_m).array().floor().cast<int>();
  }
  void lower(const Eigen::Vector2i& cell, double height_m);

  CellChunks<Sum> sums_;
  CellChunks<Height> heights_;
};

}  // namespace hqslam::slam
