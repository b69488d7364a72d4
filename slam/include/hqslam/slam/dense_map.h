#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

struct DenseMapOptions {
  /// Computed points with less are left out.
  static constexpr float kLeastPointConfidence = 0.1F;

  double voxel_m = 0.1;  ///< one point per voxel; 0.02 to 1
  /// Points farther from the sensor are left out: they hardly make the map denser.
  double max_range_m = 50.0;
  /// Smallest probability of a surface in a voxel of the map; above 0, below 1.
  double least_confidence = 0.5;
  /// Confidence of a computed point if the scan has none; 0 to 1.
  double assumed_confidence = 0.5;
  /// Bounds the memory: a voxel takes about 60 bytes.
  std::size_t max_voxels = 60'000'000;
};
/// Throws Error with field, value and constraint.
void validate(const DenseMapOptions& options);

/// A voxel of the map.
struct DenseMapPoint {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< map frame: mean of the points in it
  float confidence = 0.0F;                            ///< probability of a surface, 0 to 1
  std::uint32_t times_seen = 0;                       ///< scans with a point in it
};

/// A map of the points of all scans, measured and computed, one per voxel, in which scans vote.
///
/// Purpose: a computed point is a guess from measured ones. Later scans compute the same surface
/// from other measurements, while a wrong guess lands elsewhere or beams pass through it.
///
/// In: per scan an OrganizedCloud and the path of the sensor. Out: points in the map's frame.
/// The odds that a voxel holds a surface are
///   odds = (sum over the scans with a point in it of c / (1 - c)) (1 + N) / 2 / (1 + p)^2
/// - c, the largest confidence of the scan's points there; that of a measured one is 0.95,
///   because of mixed pixels and moving objects. Points of less than 0.1 are left out.
/// - N, the support of the 26 neighbours, since surfaces are continuous: each that is not
///   crossed by beams more often than it has points counts 1 if anything was measured there, 1/4
///   otherwise.
/// - p, the scans with a measured beam that crossed the voxel.
/// So two scans that agree double the odds of one, since wrong points seldom agree, and a computed
/// point between measured ones has a higher probability than one in the open. The form is
/// empirical: on two simulated drives a logistic regression of "a true surface is within 0.1 m" on
/// the logarithms of the sum, 1 + N and 1 + p has the coefficients 0.5 to 0.8, 1.2 to 1.5 and -0.9
/// to -1.6 for computed voxels, and -3 for the last for measured ones. The point of a voxel is the
/// mean of its measured points or, without any, of the computed ones, weighted by c. Source of the
/// idea: occupancy grids, Moravec and Elfes 1985; Hornung et al., "OctoMap", 2013. Differs from
/// OctoMap: one vote per scan and voxel; a beam votes against a voxel only if it passes near the
/// points in it and ends well beyond (src/dense_map/see_through.h); neighbours count; the odds are
/// not clamped, so that the order of the scans does not matter.
///
/// The same scans, in any order, give the same bytes for any number of threads, as long as no voxel
/// has 131,072 measured points or more (or, with intensities, 16,384 computed ones) and max_voxels
/// is not reached.
class DenseMap {
 public:
  /// Throws Error if an option is invalid.
  explicit DenseMap(const DenseMapOptions& options);
  ~DenseMap();
  DenseMap(DenseMap&&) noexcept;  ///< moved from: only assign or destroy
  DenseMap& operator=(DenseMap&&) noexcept;

  /// Adds the points of a scan. measured_rows: SensorModel::measured_rows; the other rows are
  /// computed. Confidences of the cloud take precedence: 1 is measured. Pixels that are not finite
  /// count as no return. Throws Error if the cloud's vectors do not have its shape.
  void insert(const OrganizedCloud& cloud, const std::optional<RowSelection>& measured_rows,
              const SensorPath& path);

  /// Votes against the voxels that the measured beams of a scan crossed. To be called after all
  /// scans were inserted. All pixels of the cloud must be measured. Throws Error as insert.
  void see_through(const OrganizedCloud& measured, const SensorPath& path);

  /// Number of voxels with any point, in the map or not.
  std::size_t voxels() const;
  /// Whether points were left out because max_voxels was reached.
  bool is_full() const;

  /// The voxels of least_confidence and more, in a fixed order. intensity: receives one per point,
  /// the mean of those of its points, NaN where none is known; empty if no scan had any.
  std::vector<DenseMapPoint> points(std::vector<float>* intensity = nullptr) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Writes a map with fields x y z confidence times_seen (float32, the last uint32) and, where they
/// are not empty, intensities (float32) before the confidence, as a .pcd or .ply file by its
/// name (write_cloud). Throws Error.
void write_dense_map(const std::vector<DenseMapPoint>& points, const std::string& path,
                     const std::vector<float>& intensity = {});

}  // namespace hqslam::slam
