#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "recording/reference.h"
#include "table/table_plan.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Of simulated drives: the paper's.
inline constexpr const char* kSimulatedSensor = "os1-64";

/// Whether the recording of a drive is there: one that is to be simulated was, by this simulator,
/// from the same seed, for the same sensor, to its end and long enough.
bool is_there(const TableDrive& drive);

/// Simulates a drive that is not there, calling `on_scan` after each scan. Returns false if it was
/// interrupted. Throws Error.
bool prepare_drive(const TableDrive& drive, const InterruptGuard& interrupt,
                   const std::function<void()>& on_scan);

/// What tells one recording from another, wherever they lie and however they are called: a hash of
/// the first `scans` images of a stack, or of all files of a folder with their names; and how it is
/// read, if not as usual. Throws Error.
std::string identity_of(const TableDrive& drive, std::int64_t scans);

/// The true trajectory, if there is one. Throws Error.
std::optional<TrajectoryFile> truth_of(const TableDrive& drive);

}  // namespace hqslam::tools
