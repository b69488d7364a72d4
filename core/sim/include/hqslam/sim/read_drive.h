#pragma once

#include <string>

#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// The drive that a folder's drive.json names (DriveWriter writes it). Throws Error: which file,
/// what was expected, what was found.
DriveSpec read_drive_json(const std::string& path);

}  // namespace hqslam::sim
