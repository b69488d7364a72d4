#include "files/output_guard.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "files/result_folder.h"
#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw Error(fmt::format("{}: is there already and {}; give another --out or move it",
                          path.string(), why));
}

}  // namespace

void refuse_to_replace(const fs::path& file, const Paths& inputs) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) return;
  if (!fs::is_regular_file(status)) {
    refuse(file, fs::is_directory(status) ? "is a folder" : "is no regular file");
  }
  for (const std::string& input : inputs) {
    if (!fs::equivalent(file, input, error) || error) continue;
    throw Error(fmt::format("{}: is read by this command and would be replaced; give another --out",
                            input));
  }
}

void guard_results(const fs::path& folder, std::span<const char* const> names, bool is_own,
                   const std::string& but, const Paths& inputs) {
  for (const char* name : names) {
    std::error_code error;
    if (!is_own && fs::exists(folder / name, error)) refuse(folder / name, but);
    refuse_to_replace(folder / name, inputs);
  }
}

void guard_output_file(const std::string& path, const Paths& inputs,
                       const std::function<bool(const std::string&)>& is_own) {
  const fs::path folder = fs::absolute(path).parent_path();
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Error(fmt::format("{}: expected an existing folder to write it into, found none; make {}",
                            path, folder.string()));
  }
  refuse_to_replace(path, inputs);
  if (fs::exists(path, error) && !is_own(path)) refuse(path, "was not written by this command");
  require_writable(folder);
}

bool has_marker(const std::string& path, const std::string& marker) {
  constexpr std::streamsize kMarkerWithin = 4096;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;  // reading from a pipe would wait for ever
  std::string beginning(kMarkerWithin, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(beginning.data(), kMarkerWithin);
  return beginning.find(marker) != std::string::npos;
}

}  // namespace hqslam::tools
