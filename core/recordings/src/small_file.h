#pragma once

#include <cstdint>
#include <string>

namespace hqslam::recordings {

/// All of a file that describes a sensor. Throws Error if it is no file or larger than that;
/// `what`: "an Ouster's metadata (.json)".
std::string small_file(const std::string& path, std::uintmax_t most_bytes, const std::string& what);

}  // namespace hqslam::recordings
