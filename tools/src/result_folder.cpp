#include "result_folder.h"

#include <fmt/format.h>

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
  const std::filesystem::path probe = folder / ".hqslam-probe";
  if (!std::ofstream(probe)) {
    throw Error(
        fmt::format("{}: no file can be written there; give another --out", folder.string()));
  }
  std::filesystem::remove(probe, error);
}

}  // namespace hqslam::tools
