#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::tools {

/// A step of the ranges of range images on pages: finer than the noise of the sensors.
inline constexpr float kRangeStep_m = 0.02F;

/// The range image of a scan, of every n-th column of its sensor, and where the sensor was.
struct ViewRangeImage {
  std::string name;
  std::int64_t number = 0;               ///< its name in links: page.html#scan=3
  Pose T_map_sensor = Pose::Identity();  ///< at the stamp
  Pose T_map_other = Pose::Identity();   ///< at another time, `other_s` after it
  double other_s = 0.0;                  ///< 0: the motion is not known
  std::span<const std::uint16_t> range;  ///< rows x columns in steps of kRangeStep_m; 0: no return
  std::span<const float> time_offset_s;  ///< of each column; not a number: not known
};

/// The scans of a drive, which are shown one at a time.
struct ViewDrive {
  SensorModel sensor;
  std::vector<ViewRangeImage> scans;
};

/// As tools/web/drive_scans.js reads it: 4 bits for a pixel without a return or as far away as its
/// neighbour, some 6 bits for a pixel on average.
nlohmann::ordered_json drive_json(const ViewDrive& drive);

}  // namespace hqslam::tools
