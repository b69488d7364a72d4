#pragma once

#include "commands.h"

namespace hqslam::tools {

/// In every file that --json writes: tells it from others.
inline constexpr const char* kCompareJsonMarker = "hqslam compare";

/// `hqslam compare --protocol tulip`: KITTI .bin files lifted and scored as tulip_protocol.h says.
/// Returns an ExitStatus. Throws Error.
int compare_with_tulip(const CompareOptions& options);

}  // namespace hqslam::tools
