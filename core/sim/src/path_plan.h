#pragma once

#include <cstdint>

#include "driver_path.h"
#include "layout.h"
#include "style.h"

namespace hqslam::sim {

/// The parts of a drive, each with a seed of its own.
enum class DrivePart : std::uint64_t { kCity = 1, kPath, kSway, kTraffic, kNoise, kConditions };
std::uint64_t seed_of_part(std::uint64_t drive_seed, DrivePart part);

/// The way of the sensor's car for at least `duration_s` and as long as traffic looks ahead. A
/// longer one begins with the shorter one.
DriverPath plan_path(const Layout& layout, const DriverStyle& style, std::uint64_t drive_seed,
                     double duration_s);

}  // namespace hqslam::sim
