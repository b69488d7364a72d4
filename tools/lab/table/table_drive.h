#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "recording/reference.h"
#include "table/table_plan.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// The sensor of simulated drives, which is the paper's.
inline constexpr const char* kSimulatedSensor = "os1-64";

/// Whether the recording of a drive exists. A simulated drive exists if its folder has that drive,
/// made by this revision of the simulator from the same seed for the same sensor, complete and long
/// enough.
bool is_there(const TableDrive& drive);

/// Simulates a drive that does not exist, calling `on_scan` after each scan. Returns false if it
/// was interrupted. Throws Error.
bool prepare_drive(const TableDrive& drive, const InterruptGuard& interrupt,
                   const std::function<void()>& on_scan);

/// The identity of a recording, independent of its path: a hash of the first `scans` images of a
/// stack, or of all files of a folder with their names, and the options of reading that are not the
/// default. Throws Error.
std::string identity_of(const TableDrive& drive, std::int64_t scans);

/// The true trajectory, if there is one. Throws Error.
std::optional<TrajectoryFile> truth_of(const TableDrive& drive);

}  // namespace hqslam::tools
