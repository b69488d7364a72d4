#pragma once

#include <string>

namespace hqslam {

/// The bytes of a regular file. `kind` ("a .pcd file") goes into the message of the Error that is
/// thrown when there is none, it cannot be read or is larger than max_bytes.
std::string whole_file(const std::string& path, const std::string& kind, std::size_t max_bytes);

/// Writes a file, replacing any of that name. Throws Error.
void write_whole_file(const std::string& path, const std::string& bytes);

}  // namespace hqslam
