#include "small_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

std::string small_file(const std::string& path, std::uintmax_t most_bytes,
                       const std::string& what) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || !std::filesystem::is_regular_file(path, error) || bytes > most_bytes) {
    throw Error(
        fmt::format("{}: expected {}, found no such file or one above {} MiB; give the file of "
                    "this very sensor",
                    path, what, most_bytes >> 20U));
  }
  std::ifstream stream(path, std::ios::binary);
  std::string contents(bytes, '\0');
  stream.read(contents.data(), static_cast<std::streamsize>(bytes));
  contents.resize(static_cast<std::size_t>(stream.gcount()));
  return contents;
}

}  // namespace hqslam::recordings
