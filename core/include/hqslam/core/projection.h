#pragma once

#include <cstdint>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// What became of the points of a scan.
struct ProjectionCounts {
  std::int64_t kept = 0;
  std::int64_t out_of_range = 0;      ///< nearer than min_range_m or farther than max_range_m
  std::int64_t outside_rows = 0;      ///< above the highest or below the lowest beam
  std::int64_t hidden_by_nearer = 0;  ///< another point of the same pixel was nearer
};

struct ProjectedScan {
  OrganizedCloud cloud;  ///< the scan's own points, untouched, one per pixel
  ProjectionCounts counts;
};

/// Scan -> pixels. The row is Scan::row where it is known, otherwise that of the beam nearest in
/// elevation; the column is the one whose pixel contains the point's azimuth. Of several points in
/// one pixel the nearest is kept. Throws Error if a row of the scan is not a row of the sensor, or
/// rows do not fall with the elevation of their points.
ProjectedScan project(const Scan& scan, const SensorModel& sensor);

/// The pixels that have a return, row after row, with all that is known of them.
Scan returns_of(const OrganizedCloud& cloud);

/// When the pixels of a range image were captured.
enum class CaptureTime {
  kRolling,          ///< measured one column after the other (SensorModel::firing_column)
  kMotionCorrected,  ///< all as if measured at the scan's stamp
};

/// Range image -> points at the centres of the pixels, which `project` maps back to those pixels.
/// first_column, from 0: the column at which the turn begins. Throws Error if the shapes of image
/// and sensor differ.
OrganizedCloud unproject(const RangeImage& image, const SensorModel& sensor,
                         CaptureTime capture_time, int first_column = 0);

/// The column at which a scan begins, determined from the times of its points: some sensors begin
/// each turn where the one before has ended. 0 without times.
int first_column(const OrganizedCloud& cloud, const SensorModel& sensor);

}  // namespace hqslam
