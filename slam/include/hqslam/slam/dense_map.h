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
  /// A computed point with less is left out.
  static constexpr float kLeastPointConfidence = 0.1F;

  double voxel_m = 0.1;  ///< one point per voxel; 0.02 to 1
  /// Of a point from the sensor, beyond which it is left out: what is farther hardly gets denser.
  double max_range_m = 50.0;
  /// A voxel is in the map if it is a surface with at least this probability; above 0, below 1.
  double least_confidence = 0.5;
  /// Of a computed point, where the scan has no confidences of its own; 0 to 1.
  double assumed_confidence = 0.5;
  /// Memory is bounded by it: a voxel takes about 50 bytes, and 8 more with intensities.
  std::size_t max_voxels = 60'000'000;
};
/// Throws Error with field, value and constraint.
void validate(const DenseMapOptions& options);

/// What is known of a voxel.
struct DenseMapPoint {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< map frame: mean of the points in it
  float confidence = 0.0F;                            ///< that there is a surface, 0 to 1
  std::uint32_t times_seen = 0;                       ///< scans with a point in it
};

/// A map of all points of all scans, measured and computed, one per voxel, in which scans vote.
///
/// Purpose: a computed point alone is a guess that follows from two measured ones. When the sensor
/// has moved on, the same surface follows from other measurements, and a wrong guess lands
/// elsewhere or is seen through.
///
/// In: per scan an OrganizedCloud and the path of the sensor. Out: points in the map's frame.
/// The odds that a voxel holds a surface are
///   odds = (sum over the scans with a point in it of c / (1 - c)) (1 + N) / 2 / (1 + p)^2
/// - c, the largest confidence of a point that the scan has there; a measured one's is 0.95, for
///   pixels can mix, and people walk. A point of less than 0.1 is left out.
/// - N, what the 26 neighbours say, for surfaces go on: each that is not seen through more often
///   than seen counts 1 if anything was measured there, 1/4 otherwise.
/// - p, the scans of which a measured beam went through the voxel and on.
/// So two scans that agree double the odds of one, wrong points having no reason to agree, and a
/// computed point between measured ones is believed sooner than one in the open. Form and numbers
/// are those of measurements: on two simulated drives a logistic regression of "a true surface is
/// within 0.1 m" on the logarithms of the sum, 1 + N and 1 + p has the coefficients 0.5 to 0.8, 1.2
/// to 1.5 and -0.9 to -1.6 for computed voxels; -3 the last for measured ones.
/// Where anything was measured the voxel's point is the mean of the measured ones, otherwise that
/// of the computed ones, weighted by c.
/// Source of the idea: occupancy grids, Moravec and Elfes 1985; Hornung et al., "OctoMap", 2013.
/// Differs from OctoMap: one vote per scan and voxel; a beam votes against a voxel only if it
/// passes near the points in it and ends well beyond (src/dense_map/see_through.h); neighbours
/// count; the odds are not clamped, so that the order of the scans does not matter.
///
/// The same scans, in any order, give the same bytes, whatever the number of threads, as long as no
/// voxel has 131,072 measured points or more (or, with intensities, 16,384 computed ones) and
/// max_voxels are not reached.
class DenseMap {
 public:
  /// Throws Error if an option is invalid.
  explicit DenseMap(const DenseMapOptions& options);
  ~DenseMap();
  DenseMap(DenseMap&&) noexcept;  ///< moved from: only assign or destroy
  DenseMap& operator=(DenseMap&&) noexcept;

  /// Puts a scan's points in. measured_rows: SensorModel::measured_rows; what the others have was
  /// computed. Without it (all rows), or where the cloud says so itself, the cloud's confidence
  /// tells: 1 is measured. Pixels that are not finite count as no return. Throws Error if the
  /// cloud's vectors do not have its shape.
  void insert(const OrganizedCloud& cloud, const std::optional<RowSelection>& measured_rows,
              const SensorPath& path);

  /// Votes against what the measured beams of a scan went through. Votes are about voxels that are
  /// there: call it once all scans are in. All pixels of the cloud must be measured. Throws Error
  /// as insert.
  void see_through(const OrganizedCloud& measured, const SensorPath& path);

  /// Voxels with any point at all, kept or not.
  std::size_t voxels() const;
  /// Whether points were left out because max_voxels were reached.
  bool is_full() const;

  /// The voxels of least_confidence and more, in a fixed order. intensity: takes one per point, the
  /// mean of those of the points that its place is the mean of, not a number where none is known;
  /// empty if no scan had any.
  std::vector<DenseMapPoint> points(std::vector<float>* intensity = nullptr) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Writes a map with fields x y z confidence times_seen (float32, the last uint32) and, where they
/// are not empty, intensities (float32) before the confidence: a .pcd, .ply or .las file as its
/// name says (write_cloud). Throws Error.
void write_dense_map(const std::vector<DenseMapPoint>& points, const std::string& path,
                     const std::vector<float>& intensity = {});

}  // namespace hqslam::slam
