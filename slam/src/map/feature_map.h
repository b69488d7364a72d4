#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "front_end/cell_index.h"
#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// The points of a map nearest to a place.
struct Neighbours {
  static constexpr int kWanted = 5;  ///< as in LOAM
  int count = 0;
  std::array<Eigen::Vector3f, kWanted> points_m;  ///< nearest first
  std::array<float, kWanted> squared_distance_m2{};
  /// No other point is nearer.
  float sixth_squared_m2 = 0.0F;
};

/// The points of a map about a place, from which the neighbours of places beside it follow, too.
struct NearbyPoints {
  static constexpr int kKept = 7;
  Eigen::Vector3f place_m = Eigen::Vector3f::Zero();
  int count = 0;
  std::array<Eigen::Vector3f, kKept> points_m;
  float others_beyond_m = 0.0F;  ///< distance from the place; no other point is nearer

  /// The nearest of those that are nearer to the query than any other point can be.
  Neighbours nearest(const Eigen::Vector3f& query_m) const;
};

/// The region within a radius of a place horizontally, and within half of that vertically.
struct Surroundings {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0.0F;

  float half_height_m() const { return radius_m / 2.0F; }
  bool contains(const Eigen::Vector3f& point_m) const;
};

/// A point of a map: the running mean of the first points that fell into its voxel.
struct MapPoint {
  Eigen::Vector3f mean_m;
  std::uint32_t keyframe = 0;       ///< the first that observed it
  std::uint32_t last_observed = 0;  ///< the last keyframe that did
  std::uint16_t count = 1;          ///< points averaged
  /// Mean of the known intensities; NaN without any.
  float intensity = std::numeric_limits<float>::quiet_NaN();
};

/// A map of points, thinned to one per voxel, that grows point by point and finds nearest points.
///
/// Space is cut into cubes of `2 * max_distance_m`, found by a hash; a cube keeps one point per
/// voxel of `leaf_m`, the running mean of the first points in it. A search visits the at most eight
/// cubes that a ball of max_distance_m intersects. The time of insertions and searches does not
/// depend on the size of the map: a kd-tree would have to be rebuilt with every keyframe. Exact:
/// the neighbours are those of a search through all points.
///
/// A point stores the first keyframe that observed it, with which it moves when that is corrected,
/// and the last, so that points without recent observations can be taken out. Passing a place again
/// does not add voxels.
///
/// Points farther than a million cubes from the origin are left out.
class FeatureMap {
 public:
  FeatureMap(double leaf_m, double max_distance_m);

  /// intensity: one per point, or empty.
  void insert(const std::vector<Eigen::Vector3f>& points_m, std::uint32_t keyframe = 0,
              const std::vector<float>& intensity = {});
  /// Points of another map; those that meet in one voxel are merged, and the oldest keyframe kept.
  void insert(const std::vector<MapPoint>& points);

  /// Takes out all points that no keyframe from this one on observed.
  std::vector<MapPoint> take_not_observed_since(std::uint32_t keyframe);
  /// Takes out the points about a place.
  std::vector<MapPoint> take_near(const Surroundings& place);

  /// Up to five nearest points within max_distance_m.
  Neighbours nearest(const Eigen::Vector3f& query_m) const {
    return nearby(query_m, max_distance_m_).nearest(query_m);
  }
  /// Up to kKept nearest points within reach_m, which is at most max_distance_m.
  NearbyPoints nearby(const Eigen::Vector3f& query_m, float reach_m) const;

  float max_distance_m() const { return max_distance_m_; }
  std::size_t size() const { return size_; }
  /// All points, in the order in which their cubes and voxels were added.
  std::vector<Eigen::Vector3f> points_m() const;
  /// MapPoint::intensity of each of points_m(); empty if none is known.
  std::vector<float> intensity() const;
  /// The points about a place.
  std::vector<Eigen::Vector3f> points_near_m(const Surroundings& place) const;

  /// Moves every point with its keyframe; in: T_corrected_map of each keyframe. Points that meet in
  /// one voxel are merged.
  void correct(const std::vector<Pose>& corrections);

 private:
  struct Cell : MapPoint {
    std::uint16_t voxel = 0;  ///< within the cube
  };
  struct Cube {
    std::uint64_t key = 0;
    std::vector<Cell> cells;
  };
  struct Voxel {
    std::uint64_t cube_key = 0;
    std::uint16_t in_cube = 0;
    bool operator==(const Voxel&) const = default;
  };

  Cube& find_or_add(std::uint64_t key);
  /// None beyond a million cubes.
  std::optional<Voxel> voxel_of(const Eigen::Vector3f& point_m) const;
  void insert_point(const MapPoint& point);
  template <typename Wanted>
  std::vector<MapPoint> take(const std::vector<std::size_t>& cubes, const Wanted& wanted);
  void drop_empty_cubes();
  std::vector<std::size_t> cubes_touching(const Surroundings& place) const;
  std::vector<std::size_t> all_cubes() const;

  float leaf_m_;
  float max_distance_m_;
  float cube_m_;
  int voxels_per_side_;
  std::size_t size_ = 0;
  std::vector<Cube> cubes_;
  CellIndex index_;  ///< of cubes_
};

}  // namespace hqslam::slam
