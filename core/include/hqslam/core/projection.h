#pragma once

#include <cstdint>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// Where the points of a scan went.
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

/// Scan -> pixels. The row is the scan's own where it tells, otherwise the beam nearest in
/// elevation; the column is the one whose pixel contains the point's azimuth. The nearest return
/// wins a pixel. Throws Error if a row of the scan is not a row of the sensor.
ProjectedScan project(const Scan& scan, const SensorModel& sensor);

/// The pixels that have a return, row after row, with all that is known of them.
Scan returns_of(const OrganizedCloud& cloud);

/// What the time of a pixel of a range image means.
enum class CaptureTime {
  kRolling,          ///< measured one column after the other (SensorModel::time_offset_s)
  kMotionCorrected,  ///< all as if measured at the scan's stamp
};

/// Range image -> points at the centres of the pixels. `project` of the points gives the image
/// back. first_column, from 0: where the sensor's head stands when the turn begins. Throws Error if
/// the shapes of image and sensor differ.
OrganizedCloud unproject(const RangeImage& image, const SensorModel& sensor,
                         CaptureTime capture_time, int first_column = 0);

/// Where the sensor's head stands when a scan begins, by the times of its points: some sensors
/// begin each turn where the one before has ended. 0 without times.
int first_column(const OrganizedCloud& cloud, const SensorModel& sensor);

}  // namespace hqslam
