#pragma once

#include <string>

#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// The drive that a folder's drive.json names (DriveWriter writes it). Throws Error: which file,
/// what was expected, what was found; also where its city was another one (kDriveRevision).
DriveSpec read_drive_json(const std::string& path);
/// The same of a drive that need not be simulated again.
DriveSpec read_drive_json_of_any_revision(const std::string& path);

}  // namespace hqslam::sim
