#pragma once

namespace hqslam::tools {

struct InspectOptions;

/// hqslam inspect --slam: SLAM up to one scan of a recording, and the page of that scan.
int inspect_slam(const InspectOptions& options);

}  // namespace hqslam::tools
