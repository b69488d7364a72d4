#pragma once

#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/options.h"

namespace hqslam::tools {

struct TableMethod;

/// What SLAM is told: the sensor behind the points, and its options.
struct SlamSetup {
  SensorModel sensor;
  slam::SlamOptions options;
  bool as_published = false;  ///< LeGO-LOAM with its defects instead, without options
};

/// One part of SLAM taken away or given back, to see what it is worth: METHOD+NAME is METHOD with
/// it.
struct SlamVariant {
  const char* name;
  const char* title;  ///< behind the method's, in the table
  bool (*applies)(const TableMethod& method);
  void (*change)(SlamSetup& setup);
};

/// Every variant that the program knows.
const std::vector<SlamVariant>& slam_variants();

/// "+NAME" of each.
std::vector<std::string> slam_variant_names();

/// What SLAM is told for a method: `sensor` is what its clouds come from.
SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor, bool loop_closing);

}  // namespace hqslam::tools
