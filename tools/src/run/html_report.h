#pragma once

#include <string>

#include "run/dense_map_output.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// A dense map with its pictures; both null without one.
struct DenseMapPage {
  const DenseMapRun* run = nullptr;
  const DenseMapPictures* pictures = nullptr;
};

/// report.html: one page that needs no other file and no network. Headline numbers, the trajectory
/// from above, the error over time and the time per stage; the dense map, if there is one.
std::string html_report(const SlamRun& run, const DenseMapPage& dense_map = {});

}  // namespace hqslam::tools
