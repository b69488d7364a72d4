#pragma once

#include <string>

#include "hqslam/core/scan.h"

namespace hqslam::recordings {

/// Whether the times of a recording's points can be those of a sensor that turns. In: scans of
/// points with known times, in order.
///
/// - Points that go all around the sensor in less time than any sensor takes for a turn, as where
///   all have one time or the unit is wrong, lose their times.
/// - Sensors turn clockwise seen from above. With azimuths a, time offsets t and the turn's
///   duration T, all a + 2 pi t / T are then alike; where a - 2 pi t / T are instead, the times of
///   the first scan are probably reversed. They stay, since a sensor may turn the other way.
class TimeCheck {
 public:
  /// A warning, once, or "".
  std::string check(Scan& scan, double turn_s);

 private:
  bool has_begun_ = false;
  bool has_warned_ = false;
};

}  // namespace hqslam::recordings
