#include "hqslam/slam/dense_map.h"

#include <algorithm>

#include "check_option.h"
#include "dense_map/mapped_scan.h"
#include "dense_map/see_through.h"
#include "dense_map/voxel_grid.h"
#include "dense_map/voxel_votes.h"

namespace hqslam::slam {

namespace {

template <typename Value>
std::vector<Value> joined(const std::vector<std::vector<Value>>& pieces) {
  std::vector<Value> all;
  for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

}  // namespace

void validate(const DenseMapOptions& options) {
  check_option("dense map", "voxel_m", options.voxel_m, 0.02, 1.0);
  check_option("dense map", "max_range_m", options.max_range_m, 1.0, 1000.0);
  check_option("dense map", "least_confidence", options.least_confidence, 0.001, 0.999);
  check_option("dense map", "assumed_confidence", options.assumed_confidence, 0.0, 1.0);
  check_option("dense map", "max_voxels", static_cast<double>(options.max_voxels), 1.0, 2e9);
}

struct DenseMap::Implementation {
  DenseMapOptions options;
  VoxelGrid grid;
  std::uint32_t scans = 0;  ///< calls of insert and see_through so far
  bool full = false;
  bool has_intensities = false;

  explicit Implementation(const DenseMapOptions& options_)
      : options(validated(options_)), grid(options.voxel_m) {}

  PointVote vote_of(const OrganizedCloud& cloud, std::size_t pixel, bool measured_row) const {
    if (!cloud.confidence.empty()) {
      const float confidence = cloud.confidence[pixel];
      return confidence >= 1.0F ? measured_vote() : computed_vote(confidence);
    }
    return measured_row ? measured_vote()
                        : computed_vote(static_cast<float>(options.assumed_confidence));
  }

  void add(const Eigen::Vector3d& point_m, const PointVote& vote, float intensity);
  std::vector<const VoxelBlock*> sorted_blocks() const;
  std::vector<DenseMapPoint> points_of(const VoxelBlock& block,
                                       std::vector<float>& intensity) const;
};

/// Adds a point of the scan numbered `scans` to its voxel.
void DenseMap::Implementation::add(const Eigen::Vector3d& point_m, const PointVote& vote,
                                   float intensity) {
  const auto index = grid.voxel_of(point_m);
  if (!index) return;
  if (grid.size() >= options.max_voxels && grid.find(*index) == nullptr) {
    full = true;
    return;
  }
  vote_for(grid.find_or_add(*index), point_m / options.voxel_m - index->cast<double>(), vote, scans,
           intensity);
}

/// The blocks in an order that does not depend on that of the scans.
std::vector<const VoxelBlock*> DenseMap::Implementation::sorted_blocks() const {
  std::vector<const VoxelBlock*> blocks;
  for (const VoxelBlock& block : grid.blocks()) blocks.push_back(&block);
  std::ranges::sort(blocks, std::ranges::lexicographical_compare, &VoxelBlock::index);
  return blocks;
}

std::vector<DenseMapPoint> DenseMap::Implementation::points_of(
    const VoxelBlock& block, std::vector<float>& intensity) const {
  std::vector<DenseMapPoint> points;
  block.for_each([&](const Eigen::Vector3i& index, const Voxel& voxel) {
    double support = 0.0;  // of the 26 neighbours
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i offset(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const Voxel* const neighbour = offset.isZero() ? nullptr : grid.find(index + offset);
      if (neighbour != nullptr) support += support_of(*neighbour);
    }
    const double confidence = confidence_of(voxel, support);
    if (confidence < options.least_confidence) return;
    if (has_intensities) intensity.push_back(mean_intensity(voxel));
    const Eigen::Vector3d point_m = grid.voxel_m() * (index.cast<double>() + mean_place(voxel));
    points.push_back({point_m.cast<float>(), static_cast<float>(confidence), voxel.times_seen});
  });
  return points;
}

DenseMap::DenseMap(const DenseMapOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}
DenseMap::~DenseMap() = default;
DenseMap::DenseMap(DenseMap&&) noexcept = default;
DenseMap& DenseMap::operator=(DenseMap&&) noexcept = default;

void DenseMap::insert(const OrganizedCloud& cloud, const std::optional<RowSelection>& measured_rows,
                      const SensorPath& path) {
  const MappedScan scan(cloud, path);
  Implementation& self = *implementation_;
  ++self.scans;
  const std::vector<Eigen::Vector3d> points_m = scan.points_in_map_m(self.options.max_range_m);
  const bool bright = !cloud.intensity.empty();
  self.has_intensities |= bright;
  for (int row = 0; row < cloud.rows; ++row) {
    const bool measured_row = !measured_rows || measured_rows->contains(row);
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t pixel = cloud.index(row, column);
      if (!points_m[pixel].allFinite()) continue;
      const PointVote vote = self.vote_of(cloud, pixel, measured_row);
      if (vote.odds == 0) continue;
      self.add(points_m[pixel], vote, bright ? cloud.intensity[pixel] : std::nanf(""));
    }
  }
}

void DenseMap::see_through(const OrganizedCloud& measured, const SensorPath& path) {
  const MappedScan scan(measured, path);
  Implementation& self = *implementation_;
  ++self.scans;
  std::vector<Beam> beams;
  for (std::size_t pixel = 0; pixel < measured.range_m.size(); ++pixel) {
    if (!scan.has_return(pixel)) continue;
    const Beam beam{scan.T_map_sensor(pixel).translation(), scan.point_in_map_m(pixel)};
    if (self.grid.voxel_of(beam.origin_m) && self.grid.voxel_of(beam.end_m)) beams.push_back(beam);
  }
  vote_against_seen_through(self.grid, beams, self.scans, self.options.max_range_m);
}

std::size_t DenseMap::voxels() const { return implementation_->grid.size(); }
bool DenseMap::is_full() const { return implementation_->full; }

std::vector<DenseMapPoint> DenseMap::points(std::vector<float>* intensity) const {
  const Implementation& self = *implementation_;
  const std::vector<const VoxelBlock*> blocks = self.sorted_blocks();
  std::vector<std::vector<DenseMapPoint>> points_of_block(blocks.size());
  std::vector<std::vector<float>> intensity_of_block(blocks.size());
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    points_of_block[i] = self.points_of(*blocks[i], intensity_of_block[i]);
  }
  if (intensity != nullptr) *intensity = joined(intensity_of_block);
  return joined(points_of_block);
}

}  // namespace hqslam::slam
