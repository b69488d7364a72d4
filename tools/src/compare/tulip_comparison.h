#pragma once

#include "compare/compare_command.h"

namespace hqslam::tools {

/// `hqslam compare --protocol tulip`: KITTI .bin files lifted and scored as tulip_protocol.h says.
/// Returns an ExitStatus. Throws Error.
int compare_with_tulip(const CompareOptions& options);

}  // namespace hqslam::tools
