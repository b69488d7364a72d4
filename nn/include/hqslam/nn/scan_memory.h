#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

/// Poses of a sensor during a scan: T_world_sensor when its head is at each column of the image
/// (SensorModel::firing_column), or one pose for all of a motion-corrected scan.
using ColumnPoses = std::vector<Pose>;

struct ScanMemoryOptions {
  int scans = 20;        ///< kept scans; 1 to 200
  double path_m = 40.0;  ///< scans farther back along the path are forgotten
  double time_s = 10.0;  ///< older scans are forgotten
  /// A scan replaces the one before it until the sensor has moved or turned this far since the last
  /// scan that replaced none.
  double step_m = 0.05;
  double step_rad = 0.005;
};
/// Where the poses of the whole drive are known, scans after the present one are as useful as those
/// before it: the number of later scans that are inserted before the present scan recalls.
inline constexpr int kLookAheadScans = 20;
/// The options of a memory with later scans: as many after the present scan as before it.
inline constexpr ScanMemoryOptions kLookAheadMemory = {
    .scans = 2 * kLookAheadScans + 1, .path_m = 80.0, .time_s = 20.0};
/// Throws Error with field, value and constraint.
void validate(const ScanMemoryOptions& options);

/// The measured points of the last scans, projected into the image of the present scan.
///
/// In: per scan its measured points and its column poses, in any fixed frame (that of SLAM's map).
/// Out: RecalledImage, for which every point is moved into the scan by the pose of the column that
/// would measure it:
///   p_sensor = T_world_sensor(column)^-1 p_world,  column = firing_column(row, azimuth of
///   p_sensor)
/// - begun in the middle of the scan and iterated twice more, with a cubic through the poses of the
/// columns, and the row in which the point was last measured or recalled. It falls into the pixel
/// (row, column) at
///   (v, u) pixels from its centre, -1/2 to 1/2, v in sines of the elevation between neighbouring
///   beams, and has the weight w = exp(-4 (u^2 + v^2)).
/// - Points in a pixel count if they can be on the surface of the nearest one, which hides what is
///   behind it: up to 0.15 m farther, and what a wall at an angle of 70 degrees spans in a column
///   and level ground in a row (at most 15 % of the range).
/// - On a plane 1/r is linear in the direction; so 1/M is the value at the centre of the weighted
///   regression 1/r = a + b u + c v, whose slopes, with the nearest 1/r as unit, are drawn towards
///   0 by a ridge of 0.04.
/// - W^2 = 4 sum of w, so that one point through the centre outweighs the interpolation four times.
/// A point is forgotten, because it has moved, if the measured range of its pixel is longer by more
/// than 0.5 m + 5 %; between two measured rows, if those of both rows are, in its column and in the
/// columns beside it.
///
/// Threads: one object serves one caller at a time and works with the threads that OpenMP gives.
/// Equal scans give equal bytes for any number of threads.
class ScanMemory {
 public:
  /// sensor: all rows, and which of them are measured. Throws Error if the measured rows are
  /// missing.
  explicit ScanMemory(const SensorModel& sensor, const ScanMemoryOptions& options = {});
  ~ScanMemory();
  ScanMemory(ScanMemory&&) noexcept;  ///< moved from: only assign or destroy
  ScanMemory& operator=(ScanMemory&&) noexcept;

  /// The kept points as ranges from T_world_sensor; empty where no scan is kept. measured: the
  /// measured rows of the scan at these poses, which decide which points have moved. itself_s: the
  /// stamp of that scan if the memory has it already, with later ones; it does not recall itself.
  /// Throws Error for another shape or number of poses.
  RecalledImage recall(const RangeImage& measured, const ColumnPoses& T_world_sensor,
                       std::optional<double> itself_s = std::nullopt);

  /// Keeps a scan. measured: the points of the measured rows. Throws Error as recall.
  void insert(const OrganizedCloud& measured, const ColumnPoses& T_world_sensor, double stamp_s);

  /// Forgets all scans, because the sensor was moved elsewhere or its frame has changed.
  void clear();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::nn
