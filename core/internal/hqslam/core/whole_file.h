#pragma once

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>

namespace hqslam {

/// A regular file, opened for reading. `kind` ("a .npy file") goes into the message of the Error
/// that is thrown if there is none or it cannot be read; pipes and devices, which could block for
/// ever, are refused before they are opened.
std::ifstream open_file(const std::string& path, const std::string& kind);

/// The bytes of a regular file. Throws Error as open_file does, and for a file larger than
/// max_bytes.
std::string whole_file(const std::string& path, const std::string& kind, std::size_t max_bytes);

/// Writes a file, replacing any of that name. Throws Error.
void write_whole_file(const std::string& path, const std::string& bytes);

/// Renames a file, replacing any of that name. Throws Error.
void rename_file(const std::string& from, const std::string& to);

/// Has `write` make `path`.part and renames it then: whenever the program stops, `path` is either
/// what it was or whole. A part that could not be finished is removed. Throws Error.
void replace_file(const std::string& path,
                  const std::function<void(const std::string& part)>& write);

}  // namespace hqslam
