#pragma once

#include <optional>
#include <string>

#include "interrupt.h"
#include "reference.h"
#include "table_plan.h"

namespace hqslam::tools {

/// Sees to it that the recording of a drive is there: one that is to be simulated is simulated,
/// unless it was already, from the same seed, for the same sensor, to its end and long enough.
/// Returns false if it was interrupted. Throws Error.
bool prepare_drive(const TableDrive& drive, const InterruptGuard& interrupt);

/// What tells one recording from another: what was simulated (its length apart), or the path.
std::string identity_of(const TableDrive& drive);

/// The true trajectory, if there is one. Throws Error.
std::optional<TrajectoryFile> truth_of(const TableDrive& drive);

}  // namespace hqslam::tools
