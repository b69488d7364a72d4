#pragma once

#include <string>

#include "readers.h"

namespace hqslam::fuzz {

/// The path of a file that holds these bytes until the next call; one per process, in memory where
/// the system has such a folder. `extension` is ".pcd".
std::string as_file(Bytes input, const char* extension);

}  // namespace hqslam::fuzz
