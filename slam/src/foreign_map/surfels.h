#pragma once

#include <Eigen/Core>
#include <vector>

namespace hqslam::slam {

/// A small piece of a surface: a disc about a point of a cloud.
struct Surfel {
  Eigen::Vector3f point_m;
  Eigen::Vector3f normal;  ///< of length 1; zero where the neighbours lie in no plane
  float radius_m = 0.0F;   ///< so that it reaches its neighbours'
};

/// The surface that a cloud was measured on, one surfel per voxel of leaf_m: the plane through it
/// and its four nearest neighbours within five voxels. Where it has fewer within that, it is noise
/// and left out.
std::vector<Surfel> surfels_of(const std::vector<Eigen::Vector3f>& points_m, double leaf_m);

/// Surfels by where they are, seen from above.
class SurfelTiles {
 public:
  explicit SurfelTiles(const std::vector<Surfel>& surfels);

  /// Calls draw(surfel) for all that may be within reach.
  template <typename Draw>
  void for_each_near(const Eigen::Vector3d& place_m, double reach_m, const Draw& draw) const {
    for (const Tile& tile : tiles_) {
      const Eigen::Vector2f beyond_m =
          (tile.middle_m - place_m.head<2>().cast<float>()).cwiseAbs().array() - kTile_m / 2.0F;
      if (beyond_m.cwiseMax(0.0F).norm() > reach_m) continue;
      for (const Surfel& surfel : tile.surfels) draw(surfel);
    }
  }

 private:
  static constexpr float kTile_m = 16.0F;
  struct Tile {
    Eigen::Vector2f middle_m;
    std::vector<Surfel> surfels;
  };
  std::vector<Tile> tiles_;
};

}  // namespace hqslam::slam
