#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace hqslam::tools {

/// Writes a file under another name first and renames it then: whenever the program stops, `path`
/// is either what it was or whole. Throws Error.
void write_text_file(const std::string& text, const std::string& path);

/// Whether there is a file at `path` that holds `marker` among its first 4096 bytes: the command
/// that puts the marker there wrote it.
bool has_marker(const std::string& path, const std::string& marker);

/// Throws Error if the folder that `path` is to be in is not there: said before the work, not after
/// it.
void require_folder_of(const std::string& path);

/// Throws Error if there is something at `path` without `marker`: it must not be replaced.
void refuse_to_replace_foreign(const std::string& path, const std::string& marker);

/// Throws Error if one of these is in the folder. `but`: why it must not be replaced.
void refuse_existing(const std::filesystem::path& folder, std::span<const char* const> names,
                     const std::string& but);

}  // namespace hqslam::tools
