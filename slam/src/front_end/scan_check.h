#pragma once

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// Throws Error if a scan is not of this sensor, if a pixel lacks a point, a range or a capture
/// time while others have one, or if the stamp is no time in seconds. Throws ScanError if the
/// capture times of its returns are farther from the stamp than a scan lasts, or reach over a scan
/// that the stamp is not in the middle of.
void check(const OrganizedCloud& cloud, double stamp_s, const SensorModel& sensor);

/// Whether all pixels hold what they should: no return, or a finite point at a finite range and
/// time.
bool all_sound(const OrganizedCloud& cloud);

/// The cloud with unsound pixels emptied.
OrganizedCloud without_unsound(const OrganizedCloud& cloud);

}  // namespace hqslam::slam
