#pragma once

#include <cstdint>

#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// The share of a signal that rain or fog lets through to a surface at `range_m` and back.
double transmission(double extinction_per_m, double range_m);

/// What a pixel that would report `range_m` (0: nothing) reports under these conditions; lidar.h
/// has the formulas. Without any it is `range_m` itself.
float disturbed_range_m(float range_m, const SensingConditions& conditions,
                        const SensorModel& sensor, std::uint64_t random_bits);

}  // namespace hqslam::sim
