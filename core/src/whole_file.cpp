#include "hqslam/core/whole_file.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "hqslam/core/error.h"

namespace hqslam {

std::string whole_file(const std::string& path, const std::string& kind, std::size_t max_bytes) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  const auto size = regular ? std::filesystem::file_size(path, error) : 0;
  if (!regular || error) {
    throw Error("{}: expected {}, found {}; check the path", path, kind,
                std::filesystem::is_directory(path, error) ? "a folder" : "no file");
  }
  if (size > max_bytes) {
    throw Error("{}: expected {} of at most {} bytes, found {} bytes; check the path", path, kind,
                max_bytes, size);
  }
  std::string bytes(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) {
    throw Error(
        "{}: expected {} that can be read, found {} of {} bytes; check its permissions and the "
        "disk",
        path, kind, stream.gcount(), size);
  }
  return bytes;
}

void write_whole_file(const std::string& path, const std::string& bytes) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.flush();
  if (!stream) {
    throw Error(
        "{}: cannot be written; check that the folder exists, is writable and has free space",
        path);
  }
}

void replace_file(const std::string& path,
                  const std::function<void(const std::string& part)>& write) {
  const std::string part = path + ".part";
  std::error_code failure;
  try {
    write(part);
  } catch (...) {
    std::filesystem::remove(part, failure);
    throw;
  }
  std::filesystem::rename(part, path, failure);
  if (!failure) return;
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  throw Error("{}: cannot be written ({}); check that the folder is writable", path,
              failure.message());
}

}  // namespace hqslam
