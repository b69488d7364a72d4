#pragma once

#include <filesystem>
#include <string>

#include "files/output_guard.h"

namespace hqslam::tools {

/// Makes room for a drive in a folder: removes the files of an earlier simulated drive, so that
/// none of its scans mixes with the new ones. Throws Error, touching nothing, if the folder holds a
/// file of one of those names that is not part of a simulated drive, or one of `inputs`. is_own: it
/// is known to be one, however damaged.
void clear_drive_folder(const std::string& folder, const Paths& inputs = {}, bool is_own = false);

/// Removes 000000.EXTENSION, 000001.EXTENSION and so on from a folder, and no other file.
void remove_numbered_scans(const std::filesystem::path& folder, const std::string& extension);

}  // namespace hqslam::tools
