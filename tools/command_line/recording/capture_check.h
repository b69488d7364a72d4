#pragma once

#include <optional>
#include <string>

#include "hqslam/core/projection.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::tools {

/// How well scans fit each other as captured while the sensor turned, and as corrected for motion.
struct CaptureCheck {
  int scans = 0;             ///< that were compared: those in which the sensor moved
  double rolling_m = 0.0;    ///< median distance of features from their surfaces, mean over scans
  double corrected_m = 0.0;  ///< the same
  std::optional<CaptureTime> verdict;  ///< nothing where both fit alike
  /// Of .bin files, which by convention are corrected; KITTI's raw drives are not.
  bool is_of_kitti = false;
  /// Of the sensor from scan to scan, if rolling: more than 1 where scans without stamps were left
  /// out.
  int turns = 1;
};

/// Points without times do not determine which of the two they are, and corrected ones may still
/// have their times; if it is assumed wrongly, the path of a car is off by decimetres. The scans
/// decide: up to 100 of them go through SLAM both ways, with progress on stderr.
/// With d_i the median distance of what is not ground from its line or plane in the map, of scan i,
/// the mean of log(d_i rolling / d_i corrected) over scans in which the sensor moved must differ
/// from 0 by 2.5 of its standard errors. Scans without stamps are taken as those of every turn; as
/// those of every second, third, ... turn the motion within each is less, and rolling ones are
/// tried so as long as they fit better. Throws Error where the recording cannot be opened. options:
/// those of the recording apart from its sensor.
CaptureCheck check_capture(const std::string& input, const SensorModel& sensor,
                           const recordings::OpenOptions& options = {});

/// --stamps of scans without stamps: the seconds of so many turns.
std::string stamps_text(int turns, const SensorModel& sensor);

/// check_capture() of clouds without times, whose capture was not stated. Nothing for other
/// recordings, or those that cannot be read twice.
std::optional<CaptureCheck> check_clouds_without_times(const std::string& input,
                                                       const recordings::OpenOptions& options);

/// "74 scans that moved fit each other within 62.1 mm as captured while the sensor turned, within
/// 67.5 mm as corrected for motion", or that this does not determine it.
std::string fit_text(const CaptureCheck& check);

}  // namespace hqslam::tools
