#include "text_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "hqslam/core/error.h"

namespace hqslam::tools {

void write_text_file(const std::string& text, const std::string& path) {
  const std::string part = path + ".part";
  std::ofstream stream(part, std::ios::binary);
  stream << text;
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(part, path, error);
  if (!stream || error) {
    throw Error(
        fmt::format("{}: cannot be written; is the folder writable and the disk not full?", path));
  }
}

}  // namespace hqslam::tools
