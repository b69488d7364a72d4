#pragma once

#include <array>
#include <chrono>
#include <string_view>

#include "hqslam/slam/slam.h"

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

/// One stage of SLAM: its name and where its time stands.
struct Stage {
  std::string_view name;
  double slam::StageTimes::*seconds;
};
/// In the order in which they run; `total` is not among them.
inline constexpr std::array<Stage, 5> kStages = {{
    {"segmentation", &slam::StageTimes::segmentation_s},
    {"features", &slam::StageTimes::features_s},
    {"odometry", &slam::StageTimes::odometry_s},
    {"mapping", &slam::StageTimes::mapping_s},
    {"loops", &slam::StageTimes::loop_closing_s},
}};

}  // namespace hqslam::tools
