#include "hqslam/core/whole_file.h"

#include <filesystem>
#include <system_error>

#include "hqslam/core/error.h"

namespace hqslam {

std::ifstream open_file(const std::string& path, const std::string& kind) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::is_regular_file(status)) {
    throw Error("{}: expected {}, found {}; check the path", path, kind,
                std::filesystem::is_directory(status) ? "a folder"
                : std::filesystem::exists(status)     ? "a pipe or a device"
                                                      : "no file");
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw Error("{}: expected {} that can be read; check its permissions", path, kind);
  }
  return stream;
}

std::string whole_file(const std::string& path, const std::string& kind, std::size_t max_bytes) {
  std::ifstream stream = open_file(path, kind);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);  // the largest number on failure
  if (size > max_bytes) {
    throw Error("{}: expected {} of at most {} bytes, found {} bytes; check the path", path, kind,
                max_bytes, size);
  }
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) {
    throw Error("{}: expected {} of {} bytes, could read {}; check the disk", path, kind, size,
                stream.gcount());
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

void rename_file(const std::string& from, const std::string& to) {
  std::error_code failure;
  std::filesystem::rename(from, to, failure);
  if (!failure) return;
  throw Error("{}: cannot be written ({}); check that the folder is writable", to,
              failure.message());
}

void replace_file(const std::string& path,
                  const std::function<void(const std::string& part)>& write) {
  const std::string part = path + ".part";
  try {
    write(part);
    rename_file(part, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

}  // namespace hqslam
