#include "files/text_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"

namespace hqslam::tools {

void write_text_file(const std::string& text, const std::string& path) {
  replace_file(path, [&](const std::string& part) { write_whole_file(part, text); });
}

bool has_marker(const std::string& path, const std::string& marker) {
  constexpr std::streamsize kMarkerWithin = 4096;
  std::string beginning(kMarkerWithin, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(beginning.data(), kMarkerWithin);
  return beginning.find(marker) != std::string::npos;
}

void require_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (std::error_code error; std::filesystem::is_directory(folder, error)) return;
  throw Error(fmt::format("{}: expected an existing folder to write it into, found none; make {}",
                          path, folder.string()));
}

void refuse_to_replace_foreign(const std::string& path, const std::string& marker) {
  std::error_code error;
  if (!std::filesystem::exists(path, error) || has_marker(path, marker)) return;
  throw Error(fmt::format(
      "{}: is there already and was not written by this command; give another name or move it",
      path));
}

void refuse_existing(const std::filesystem::path& folder, std::span<const char* const> names,
                     const std::string& but) {
  for (const char* name : names) {
    if (!std::filesystem::exists(folder / name)) continue;
    throw Error(fmt::format("{}: is there already {}; give another --out or move it",
                            (folder / name).string(), but));
  }
}

}  // namespace hqslam::tools
