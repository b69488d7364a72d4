#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hqslam::tools {

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

}  // namespace hqslam::tools
