#pragma once

#include <chrono>

namespace hqslam::tools {

using SteadyClock = std::chrono::steady_clock;

inline double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// Seconds that `work` takes.
template <typename Work>
double seconds_of(const Work& work) {
  const SteadyClock::time_point start = SteadyClock::now();
  work();
  return seconds_since(start);
}

}  // namespace hqslam::tools
