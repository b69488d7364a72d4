#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// Steepest rise from row to row on the ground: 10 degrees, as in LeGO-LOAM.
inline constexpr double kMaxGroundSlope_rad = 0.17453292519943295;

/// Marks the pixels on the ground.
///
/// In: a cloud in the level frame (z up), the sensor, and the vertical in the frame of its beams,
/// (0, 0, 1) where it is mounted level. Out: 1 per pixel of the ground, 0 elsewhere. Within a
/// column, two successive returns from below are ground if the line through them rises or falls by
/// at most max_slope_rad. Source: LeGO-LOAM, section 4 A of its paper.
///
/// Differs from LeGO-LOAM: the beams more than half a degree below the horizon are searched, for
/// any sensor and mounting, not a fixed number of rows; one or two beams without a return do not
/// end the ground, the next return above them is compared.
std::vector<std::uint8_t> mark_ground(
    const OrganizedCloud& cloud, const SensorModel& sensor,
    const Eigen::Vector3d& up_of_sensor = Eigen::Vector3d::UnitZ(),
    double max_slope_rad = kMaxGroundSlope_rad);

}  // namespace hqslam::slam
