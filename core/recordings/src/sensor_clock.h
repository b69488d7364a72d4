#pragma once

#include <cstdint>

namespace hqslam::recordings {

/// Time of the recording from the even clock of a sensor.
///
/// Purpose: packets are recorded with a jitter of up to milliseconds, but the sensor's own time of
/// them is exact to a microsecond; its zero is whatever it is, and it runs a little fast or slow.
/// In:  a time by the sensor's clock and the time at which the packet was recorded, ns.
/// Out: the sensor's time + an offset, ns since 1970. The offset is that of the first packet and
///      follows the recorder's clock by at most kMaxSlew of the time that passes, so that stamps
///      neither jitter nor drift apart. Where the two are farther apart than kMaxApart_ns, one of
///      the clocks was set, and the offset is taken anew.
class SensorClock {
 public:
  std::int64_t recorded_ns(std::int64_t sensor_ns, std::int64_t capture_ns);

 private:
  bool set_ = false;
  std::int64_t offset_ns_ = 0;
  std::int64_t last_sensor_ns_ = 0;
};

}  // namespace hqslam::recordings
