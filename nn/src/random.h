#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace hqslam::nn {

/// splitmix64: the standard library's distributions differ from one to the next, these do not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t v = state_ += 0x9E3779B97F4A7C15ULL;
    v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9ULL;
    v = (v ^ (v >> 27)) * 0x94D049BB133111EBULL;
    return v ^ (v >> 31);
  }
  /// 0 to below 1.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// 0 to count - 1.
  std::int64_t below(std::int64_t count) {
    return static_cast<std::int64_t>(unit() * static_cast<double>(count));
  }
  double normal() {
    // One statement each: in one expression the compiler would choose which is drawn first.
    const double radius = std::sqrt(-2.0 * std::log(1.0 - unit()));
    return radius * std::cos(2.0 * std::numbers::pi * unit());
  }

 private:
  std::uint64_t state_;
};

}  // namespace hqslam::nn
