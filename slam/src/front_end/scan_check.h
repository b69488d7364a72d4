#pragma once

#include <optional>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// Throws Error unless each pixel has a point and a range, and all or none have a capture time, a
/// confidence, an intensity.
void check_shape(const OrganizedCloud& cloud);

/// Throws Error if a scan does not have the shape of this sensor's (check_shape), or if the stamp
/// is no time in seconds. Throws ScanError if the capture times of its returns are farther from the
/// stamp than a scan lasts, or span a scan whose middle is not the stamp.
void check(const OrganizedCloud& cloud, double stamp_s, const SensorModel& sensor);

/// Whether a pixel is empty or has a finite point, range and capture time.
bool is_sound(const OrganizedCloud& cloud, std::size_t pixel);

/// The cloud with unsound pixels emptied; nothing where all are sound.
std::optional<OrganizedCloud> without_unsound(const OrganizedCloud& cloud);

}  // namespace hqslam::slam
