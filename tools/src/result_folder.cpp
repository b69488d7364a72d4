#include "result_folder.h"

#include <fmt/format.h>

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
}

}  // namespace hqslam::tools
