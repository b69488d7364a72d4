#pragma once

#include <string>

namespace hqslam::tools {

/// Writes a file under another name first and renames it then: whenever the program stops, `path`
/// is either what it was or whole. Throws Error.
void write_text_file(const std::string& text, const std::string& path);

}  // namespace hqslam::tools
