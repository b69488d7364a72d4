#pragma once

#include <string>

namespace hqslam::fuzz {

/// Writes the inputs that fuzzing begins with: folder/READER/NAME, small and valid. What was in the
/// folder is gone. `golden_folder`: tests/golden.
void write_seeds(const std::string& folder, const std::string& golden_folder);

}  // namespace hqslam::fuzz
