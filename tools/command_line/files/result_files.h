#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hqslam/core/file_descriptor.h"

namespace hqslam::tools {

// One guard for every writer: no command replaces what it did not write. Each function is called
// before the work, touches nothing, and throws Error, which names the obstacle.

using Paths = std::vector<std::string>;

/// Refuses what is there and no regular file (a folder, a device, a pipe, a link to nothing), and
/// what is one of the command's own inputs.
void refuse_to_replace(const std::filesystem::path& file, const Paths& inputs);

/// refuse_to_replace for files of a command's folder of results, none of which is replaced unless
/// `is_own` holds: the folder has the mark of the command. `but`: why not.
void guard_results(const std::filesystem::path& folder, std::span<const char* const> names,
                   bool is_own, const std::string& but, const Paths& inputs = {});

/// refuse_to_replace for a single file, which may only replace one for which `is_own` holds; its
/// folder must exist and take files.
void guard_output_file(const std::string& path, const Paths& inputs,
                       const std::function<bool(const std::string&)>& is_own);

/// guard_output_file where has_marker identifies own files.
void guard_output_file(const std::string& path, const Paths& inputs, const std::string& marker);

/// Whether there is a file at `path` that holds `marker` among its first 4096 bytes: the command
/// that puts the marker there wrote it.
bool has_marker(const std::string& path, const std::string& marker);

/// Removes the results of an earlier run, and what a killed one left of them.
void remove_results(const std::filesystem::path& folder, std::span<const char* const> names);

/// Makes the folder for a command's results, with all above it. Throws Error if it cannot be made
/// or no file can be written into it: before the work, not after it.
void make_result_folder(const std::filesystem::path& folder);

/// Throws Error if no file can be written into a folder.
void require_writable(const std::filesystem::path& folder);

/// A lock on a folder that is there, for as long as the object lives; it ends with the program,
/// however that ends. Two programs that write the same files into a folder would leave neither's.
/// Throws Error if another has the folder; where the file system has no locks there is none.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  FileDescriptor descriptor_;
};

/// A file or folder that is gone, with what is in it, when the object is.
struct RemovedAtEnd {
  explicit RemovedAtEnd(std::filesystem::path what) : path(std::move(what)) {}
  ~RemovedAtEnd();
  RemovedAtEnd(const RemovedAtEnd&) = delete;
  RemovedAtEnd& operator=(const RemovedAtEnd&) = delete;

  const std::filesystem::path path;
};

/// Files that are written under other names and get theirs together, once all are whole. Those that
/// have none when it ends are removed.
class PartFiles {
 public:
  PartFiles() = default;
  ~PartFiles();
  PartFiles(const PartFiles&) = delete;
  PartFiles& operator=(const PartFiles&) = delete;

  /// The name to write a file under that is to be called `path`: `path`.part.
  std::string add(const std::filesystem::path& path);
  /// Throws Error.
  void rename();

 private:
  std::vector<std::filesystem::path> paths_;
};

/// Writes a file under another name first and renames it then: whenever the program stops, `path`
/// is either what it was or whole. Throws Error.
void write_text_file(const std::string& text, const std::string& path);

/// The number of scans that a simulated drive is to have, by its drive.json (hqslam-lab simulate
/// writes one); nothing for a file that is none, whatever is wrong with it.
std::optional<std::int64_t> scans_of_simulated_drive(const std::string& drive_json);

/// What a command writes into a folder of scans: files, and folders of numbered files that end as
/// the folder is called.
struct ScanFolder {
  std::span<const char* const> files;
  std::span<const char* const> scan_folders;
  std::string_view marker;  ///< one of the files: it is replaced, not removed
};
/// guard_results() of a whole ScanFolder.
void guard_scan_folder(const std::filesystem::path& folder, const ScanFolder& names, bool is_own,
                       const std::string& but, const Paths& inputs = {});
/// Removes all of it but the marker, and no other file.
void clear_scan_folder(const std::filesystem::path& folder, const ScanFolder& names);

/// Makes room for a drive in a folder: removes the files of an earlier simulated drive, so that
/// none of its scans mixes with the new ones. Throws Error, touching nothing, if the folder holds a
/// file of one of those names that is not part of a simulated drive, or one of `inputs`.
void clear_drive_folder(const std::string& folder, const Paths& inputs = {});

}  // namespace hqslam::tools
