#include "files/installed_weights.h"

#include <array>
#include <filesystem>
#include <system_error>

namespace hqslam::tools {

std::optional<std::string> installed_weights(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::array<fs::path, 2> folders = {
      program.parent_path().parent_path() / HQSLAM_WEIGHTS_INSTALLED, HQSLAM_WEIGHTS_SOURCE};
  for (const fs::path& folder : folders) {
    if (fs::is_regular_file(folder / name, error)) return (folder / name).string();
  }
  return std::nullopt;
}

}  // namespace hqslam::tools
