#pragma once

#include <filesystem>

namespace hqslam::tools {

/// Makes the folder for a command's results, with all above it. Throws Error if it cannot be made
/// or no file can be written into it: before the work, not after it.
void make_result_folder(const std::filesystem::path& folder);

}  // namespace hqslam::tools
