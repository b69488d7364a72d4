#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace hqslam {

/// The bytes of a regular file. `kind` ("a .pcd file") goes into the message of the Error that is
/// thrown when there is none, it cannot be read or is larger than max_bytes.
std::string whole_file(const std::string& path, const std::string& kind, std::size_t max_bytes);

/// Writes a file, replacing any of that name. Throws Error.
void write_whole_file(const std::string& path, const std::string& bytes);

/// Has `write` make `path`.part and renames it then: whenever the program stops, `path` is either
/// what it was or whole. A part that could not be finished is removed. Throws Error.
void replace_file(const std::string& path,
                  const std::function<void(const std::string& part)>& write);

}  // namespace hqslam
