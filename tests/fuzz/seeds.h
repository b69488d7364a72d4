#pragma once

#include <string>

namespace hqslam::fuzz {

/// Writes the inputs that fuzzing begins with: folder/READER/NAME, small and valid. What was in the
/// folder is gone.
void write_seeds(const std::string& folder);

}  // namespace hqslam::fuzz
