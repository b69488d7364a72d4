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

std::string read_small_text_file(const std::string& path, const std::string& expected) {
  constexpr std::size_t kLargestBytes = 1 << 20;
  std::string text(kLargestBytes + 1, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  const auto bytes = static_cast<std::size_t>(stream.gcount());
  if (!stream.eof() || bytes > kLargestBytes) {
    throw Error(fmt::format("{}: expected {} of at most 1 MB, cannot read it", path, expected));
  }
  text.resize(bytes);
  return text;
}

void refuse_to_replace_foreign(const std::string& path, const std::string& marker) {
  constexpr std::streamsize kMarkerWithin = 4096;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return;
  std::string beginning(kMarkerWithin, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(beginning.data(), kMarkerWithin);
  if (beginning.find(marker) != std::string::npos) return;
  throw Error(fmt::format(
      "{}: is there already and was not written by this command; give another name or move it",
      path));
}

}  // namespace hqslam::tools
