#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "occupancy_grid/cell_chunks.h"

namespace hqslam::slam {

/// How high the ground is, from places where it was seen; see OccupancyGrid. Map frame.
class GroundHeights {
 public:
  static constexpr double kCell_m = 0.5;

  /// Whether a point can be counted in cells at all: within 1,000 km, and finite.
  static bool is_near(const Eigen::Vector3d& point_m) {
    return (point_m.cwiseAbs().array() < kFarthest_m).all();
  }
  /// A point that is near.
  void add(const Eigen::Vector3d& point_m);
  /// Of a place, once all points are in and `settle` was called; nothing where none is near.
  std::optional<double> at(const Eigen::Vector2d& place_m) const;
  /// The lower envelope of what was added.
  void settle();
  /// Calls visit(square) for each of kCell_m where `at` knows it.
  template <typename Visit>
  void for_each_known(const Visit& visit) const {
    heights_.for_each([&](const Eigen::Vector2i& cell, const Height& height) {
      const Eigen::Vector2d corner_m = kCell_m * cell.cast<double>();
      if (height.is_known) visit(Eigen::AlignedBox2d(corner_m, corner_m.array() + kCell_m));
    });
  }

 private:
  static constexpr double kFarthest_m = 1e6;
  /// Sums are whole numbers, so that the order of the points does not matter.
  struct Seen {
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

  CellChunks<Seen> seen_;
  CellChunks<Height> heights_;
};

}  // namespace hqslam::slam
