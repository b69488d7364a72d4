#pragma once

#include <string>

#include "readers.h"

namespace hqslam::fuzz {

/// The path of a file that holds these bytes until the next call with this extension, say ".pcd";
/// in memory where the system has such a folder.
std::string as_file(Bytes input, const char* extension);

/// The same for a reader that takes all of its file by whole_file. The fuzzers make no file for it:
/// they give whole_file's callers the bytes themselves.
std::string as_whole_file(Bytes input, const char* extension);

}  // namespace hqslam::fuzz
