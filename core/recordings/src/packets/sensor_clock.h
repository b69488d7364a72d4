#pragma once

#include <algorithm>
#include <cstdint>

namespace hqslam::recordings {

/// Time of the recording from the even clock of a sensor.
///
/// Purpose: packets are recorded with a jitter of up to milliseconds, but the sensor's own time of
/// them is exact to a microsecond; its zero is arbitrary, and it runs a little fast or slow.
/// In:  a time by the sensor's clock and the time at which the packet was recorded, ns.
/// Out: the sensor's time + an offset, ns since 1970. The offset is that of the first packet and
///      follows the recorder's clock by at most kMaxSlew of the time that passes, so that stamps
///      neither jitter nor drift apart. Where the two are farther apart than kMaxApart_ns, one of
///      the clocks was set, and the offset is taken anew.
class SensorClock {
 public:
  std::int64_t recorded_ns(std::int64_t sensor_ns, std::int64_t capture_ns) {
    const std::int64_t apart = difference(difference(capture_ns, sensor_ns), offset_ns_);
    was_set_ = !begun_ || apart > kMaxApart_ns || apart < -kMaxApart_ns;
    begun_ = true;
    if (was_set_) {
      offset_ns_ = difference(capture_ns, sensor_ns);
    } else {
      const std::int64_t passed = difference(sensor_ns, last_sensor_ns_);
      const std::int64_t slew = std::clamp<std::int64_t>(passed, 0, kMaxApart_ns) / kSlewDivisor;
      offset_ns_ = sum(offset_ns_, std::clamp(apart, -slew, slew));
    }
    last_sensor_ns_ = sensor_ns;
    return sum(sensor_ns, offset_ns_);
  }
  /// Whether the last call took the offset anew, as the first one does.
  bool was_set() const { return was_set_; }

 private:
  static constexpr std::int64_t kMaxApart_ns = 500'000'000;
  /// A quartz is right to 50 millionths; two may differ by twice as much.
  static constexpr std::int64_t kSlewDivisor = 10'000;

  // The numbers may have any value.
  static std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  }
  static std::int64_t sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
  }

  bool begun_ = false;
  bool was_set_ = false;
  std::int64_t offset_ns_ = 0;
  std::int64_t last_sensor_ns_ = 0;
};

}  // namespace hqslam::recordings
