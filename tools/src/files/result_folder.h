#pragma once

#include <filesystem>

#include "hqslam/core/file_descriptor.h"

namespace hqslam::tools {

/// Makes the folder for a command's results, with all above it. Throws Error if it cannot be made
/// or no file can be written into it: before the work, not after it.
void make_result_folder(const std::filesystem::path& folder);

/// Throws Error if no file can be written into a folder.
void require_writable(const std::filesystem::path& folder);

/// A lock on a file or a folder that is there, for as long as the object lives: it ends with the
/// program, however that ends.
class FileLock {
 public:
  enum class State { kHeld, kTakenByAnother, kUnknown /* the file system knows no locks */ };
  explicit FileLock(const std::filesystem::path& path);

  State state() const { return state_; }

 private:
  FileDescriptor descriptor_;
  State state_ = State::kUnknown;
};

/// Two programs that write the same files into a folder would leave neither's. Throws Error if
/// another has the folder.
class FolderLock : public FileLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
};

}  // namespace hqslam::tools
