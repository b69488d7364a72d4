#include "files/result_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "hqslam/core/error.h"

namespace hqslam::tools {

void make_result_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored)) {
    throw Error(
        fmt::format("{}: cannot be made as a folder for the results ({}); give another --out",
                    folder.string(), error.message()));
  }
  require_writable(folder);
}

void require_writable(const std::filesystem::path& folder) {
  const std::filesystem::path probe = folder / ".hqslam-probe";
  if (!std::ofstream(probe)) {
    throw Error(
        fmt::format("{}: no file can be written there; give another --out", folder.string()));
  }
  std::error_code ignored;
  std::filesystem::remove(probe, ignored);
}

FileLock::FileLock(const std::filesystem::path& path)
    : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (!descriptor_) return;
  if (flock(descriptor_.get(), LOCK_EX | LOCK_NB) == 0) {
    state_ = State::kHeld;
  } else if (errno == EWOULDBLOCK) {
    state_ = State::kTakenByAnother;
  }
}

FolderLock::FolderLock(const std::filesystem::path& folder) : FileLock(folder) {
  if (state() != State::kTakenByAnother) return;
  throw Error(
      fmt::format("{}: another hqslam is writing into it; wait until it has ended, or give another "
                  "--out",
                  folder.string()));
}

}  // namespace hqslam::tools
