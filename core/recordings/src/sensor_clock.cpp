#include "sensor_clock.h"

#include <algorithm>

namespace hqslam::recordings {

namespace {

constexpr std::int64_t kMaxApart_ns = 500'000'000;
/// A quartz is right to 50 millionths; two may differ by twice as much.
constexpr std::int64_t kSlewDivisor = 10'000;

/// a - b where the numbers may be any.
std::int64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

}  // namespace

std::int64_t SensorClock::recorded_ns(std::int64_t sensor_ns, std::int64_t capture_ns) {
  const std::int64_t apart = difference(difference(capture_ns, sensor_ns), offset_ns_);
  if (!set_ || apart > kMaxApart_ns || apart < -kMaxApart_ns) {
    offset_ns_ = difference(capture_ns, sensor_ns);
    set_ = true;
  } else {
    const std::int64_t passed = difference(sensor_ns, last_sensor_ns_);
    const std::int64_t slew = std::clamp<std::int64_t>(passed, 0, kMaxApart_ns) / kSlewDivisor;
    offset_ns_ = sum(offset_ns_, std::clamp(apart, -slew, slew));
  }
  last_sensor_ns_ = sensor_ns;
  return sum(sensor_ns, offset_ns_);
}

}  // namespace hqslam::recordings
