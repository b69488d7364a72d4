#include "files/part_files.h"

#include <fmt/format.h>

#include <system_error>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

std::filesystem::path part_of(std::filesystem::path path) { return path += ".part"; }

}  // namespace

PartFiles::~PartFiles() {
  std::error_code ignored;
  for (const std::filesystem::path& path : paths_) std::filesystem::remove(part_of(path), ignored);
}

std::string PartFiles::add(const std::filesystem::path& path) {
  paths_.push_back(path);
  return part_of(path).string();
}

void PartFiles::rename() {
  for (const std::filesystem::path& path : paths_) {
    std::error_code error;
    std::filesystem::rename(part_of(path), path, error);
    if (error)
      throw Error(fmt::format("{}: cannot be written ({})", path.string(), error.message()));
  }
}

}  // namespace hqslam::tools
