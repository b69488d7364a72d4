#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// Nearest points found by FeatureMap, nearest first.
struct Neighbours {
  static constexpr int kWanted = 5;
  int count = 0;
  std::array<Eigen::Vector3f, kWanted> points_m;
  std::array<float, kWanted> squared_distance_m2{};
  /// With five found: the sixth is no nearer than this; the reach of the search if there is none.
  float sixth_squared_m2 = 0.0F;
};

/// What lies within a radius of a place horizontally, and within half of that vertically.
struct Surroundings {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0.0F;

  float half_height_m() const { return radius_m / 2.0F; }
  bool contains(const Eigen::Vector3f& point_m) const;
};

/// A map of points, thinned to one per voxel, that grows point by point and finds nearest points.
///
/// Space is cut into cubes of `2 * max_distance_m`, found by a hash; a cube keeps one point per
/// voxel of `leaf_m`, the running mean of the first points that fell there. A search looks at the
/// at most eight cubes that a ball of max_distance_m touches. Inserting and searching take the same
/// time however far the map reaches: a kd-tree would have to be built anew with every key frame.
/// Exact: the neighbours are those of a search through all points.
///
/// Every point remembers the key frame that first put it there, so that it can be moved when that
/// key frame turns out to have been elsewhere, and old parts of the map can be told from new ones;
/// and the last that saw it. Points not seen lately can be laid aside: searches pass them over, and
/// what is seen at their place becomes points of its own, until they are recalled. They stay in
/// their cubes: where a place is passed many times and never recalled, its cubes grow with every
/// pass, and so do the memory and the time to insert and search there.
///
/// Points farther than a million cubes from the origin are left out.
class FeatureMap {
 public:
  FeatureMap(double leaf_m, double max_distance_m);

  void insert(const std::vector<Eigen::Vector3f>& points_m, std::uint32_t key_frame = 0);

  /// Lays aside all points that no key frame from this one on has seen.
  void lay_aside_before(std::uint32_t key_frame) { oldest_in_use_ = key_frame; }

  /// Takes up again what is laid aside about a place, as if `key_frame` saw it. It is merged with
  /// the points in use of the same voxels.
  void recall(const Surroundings& place, std::uint32_t key_frame);

  /// Up to five nearest points in use within max_distance_m.
  Neighbours nearest(const Eigen::Vector3f& query_m) const;

  std::size_t size() const { return size_; }
  /// All points, in the order in which their cubes and voxels were first met.
  std::vector<Eigen::Vector3f> points_m() const;

  /// The points about a place, laid aside or not, that key frames up to `newest_key_frame` put
  /// there.
  std::vector<Eigen::Vector3f> points_near_m(const Surroundings& place,
                                             std::uint32_t newest_key_frame) const;

  /// Moves every point with its key frame: in, per key frame, T_corrected_map that takes its points
  /// to where they belong. Points that meet in one voxel are merged; the oldest key frame is kept.
  void correct(const std::vector<Pose>& corrections);

 private:
  struct Cell {
    Eigen::Vector3f mean_m;
    std::uint32_t key_frame = 0;  ///< the first that saw it
    std::uint32_t last_seen = 0;  ///< the last key frame that did
    std::uint16_t voxel = 0;      ///< within the cube
    std::uint16_t count = 0;      ///< points averaged
  };
  struct Cube {
    std::uint64_t key = 0;
    std::vector<Cell> cells;
  };

  bool in_use(const Cell& cell) const { return cell.last_seen >= oldest_in_use_; }
  bool key_of(const Eigen::Vector3i& cube, std::uint64_t& key) const;
  const Cube* find(std::uint64_t key) const;
  Cube& find_or_add(std::uint64_t key);
  void grow_table();
  void insert_cell(Cell cell);
  std::vector<std::size_t> cubes_touching(const Surroundings& place) const;

  float leaf_m_;
  float max_distance_m_;
  float cube_m_;
  int voxels_per_side_;
  std::uint32_t oldest_in_use_ = 0;
  std::size_t size_ = 0;
  std::vector<Cube> cubes_;
  std::vector<std::uint32_t> table_;  ///< open addressing: index of a cube plus one, 0 empty
};

}  // namespace hqslam::slam
