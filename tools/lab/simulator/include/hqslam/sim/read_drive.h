#pragma once

#include <string>

#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// The specification in a drive.json written by DriveWriter. Throws Error, also for a drive of
/// another revision of the simulator (kDriveRevision).
DriveSpec read_drive_json(const std::string& path);
/// The specification of a drive that need not be simulated again, of any revision. Throws Error.
DriveSpec read_drive_json_of_any_revision(const std::string& path);

}  // namespace hqslam::sim
