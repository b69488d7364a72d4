#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hqslam::tools {

// One guard for every writer: no command replaces what it did not write. Each function is called
// before the work, touches nothing, and throws Error, which says what is in the way.

using Paths = std::vector<std::string>;

/// Refuses what is there and no regular file (a folder, a device, a pipe), and what is one of the
/// command's own inputs.
void refuse_to_replace(const std::filesystem::path& file, const Paths& inputs);

/// The same for files of a command's folder of results, of which none is replaced either unless
/// `is_own` holds: the folder has the mark of the command. `but`: why not.
void guard_results(const std::filesystem::path& folder, std::span<const char* const> names,
                   bool is_own, const std::string& but, const Paths& inputs = {});

/// The same for a single file, which may only replace one that `is_own` knows; its folder must be
/// there and take files.
void guard_output_file(const std::string& path, const Paths& inputs,
                       const std::function<bool(const std::string&)>& is_own);

/// Whether there is a file at `path` that holds `marker` among its first 4096 bytes: the command
/// that puts the marker there wrote it.
bool has_marker(const std::string& path, const std::string& marker);

}  // namespace hqslam::tools
