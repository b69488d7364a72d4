#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

/// Where a sensor is while it captures a scan: T_world_sensor when its head stands at each column
/// of the image (SensorModel::firing_column), or one pose for all of a motion-corrected scan.
using ColumnPoses = std::vector<Pose>;

struct ScanMemoryOptions {
  int scans = 20;        ///< that are kept; 1 to 200
  double path_m = 40.0;  ///< what was measured farther back along the path is forgotten
  double time_s = 10.0;  ///< and what is older
  /// A scan replaces the one before it until the sensor has moved or turned so far since a scan
  /// replaced none.
  double step_m = 0.05;
  double step_rad = 0.005;
};
/// Where the way of the whole drive is known, what is measured after a scan tells as much of it as
/// what was measured before: so many later scans are remembered too before it recalls.
inline constexpr int kLookAheadScans = 20;
/// Of a memory for that: as much of what comes as of what was.
inline constexpr ScanMemoryOptions kLookAheadMemory = {
    .scans = 2 * kLookAheadScans + 1, .path_m = 80.0, .time_s = 20.0};
/// Throws Error with field, value and constraint.
void validate(const ScanMemoryOptions& options);

/// The measured points of the last scans, and what they look like from where the sensor is now.
///
/// In: per scan its measured points and its column poses, in any frame that stays (that of SLAM's
/// map). Out: RecalledImage, for which every point is moved into the scan by the pose of the column
/// that would see it:
///   p_sensor = T_world_sensor(column)^-1 p_world,  column = firing_column(row, azimuth of
///   p_sensor)
/// - begun in the middle of the scan and taken twice more, with a cubic through the poses of the
/// columns, and the row in which the point was seen last. It falls into the pixel (row, column) at
///   (v, u) pixels from its centre, -1/2 to 1/2, v in sines of the elevation between neighbouring
///   beams, and has the worth w = exp(-4 (u^2 + v^2)).
/// - Of the points in a pixel those count that may lie on the surface of the nearest, which hides
///   what is behind it: up to 0.15 m farther, and what a wall that leans by 70 degrees spans in a
///   column and level ground in a row (at most 15 % of the range).
/// - On a plane 1/r is linear in the direction; so 1/M is the value at the centre of the weighted
///   regression 1/r = a + b u + c v, whose slopes, with the nearest 1/r as unit, are drawn towards
///   0 by a ridge of 0.04.
/// - W^2 = 4 sum of w, so that one point through the centre outweighs the interpolation four times.
/// A point beyond which its pixel's measured beam now sees by more than 0.5 m + 5 % is forgotten:
/// it has moved on. So is one between two measured rows beyond which both see, in its column and in
/// those beside it.
///
/// Threads: one object serves one caller at a time and works with the threads that OpenMP gives.
/// The same scans give the same bytes, whatever their number.
class ScanMemory {
 public:
  /// sensor: all rows, and which of them are measured. Throws Error where it does not say.
  explicit ScanMemory(const SensorModel& sensor, const ScanMemoryOptions& options = {});
  ~ScanMemory();
  ScanMemory(ScanMemory&&) noexcept;  ///< moved from: only assign or destroy
  ScanMemory& operator=(ScanMemory&&) noexcept;

  /// What is remembered, seen from T_world_sensor; empty where no scan is kept. measured: the
  /// measured rows of the scan that is taken there, which decide what has moved on. itself_s: its
  /// stamp, where it is remembered already, with some that came after it; it does not recall
  /// itself. Throws Error for another shape or number of poses.
  RecalledImage recall(const RangeImage& measured, const ColumnPoses& T_world_sensor,
                       std::optional<double> itself_s = std::nullopt);

  /// Remembers a scan. measured: the points of the measured rows. Throws Error as recall.
  void insert(const OrganizedCloud& measured, const ColumnPoses& T_world_sensor, double stamp_s);

  /// Forgets all: the sensor was carried elsewhere, or its frame has changed.
  void clear();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::nn
