#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <system_error>

#include "hqslam/nn/architectures.h"
#include "hqslam/pipeline/upsampler.h"

namespace hqslam::pipeline {
namespace {

namespace fs = std::filesystem;

/// The shared object that contains this function (a Python module), or the program.
fs::path own_file() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_file), &info) == 0) return {};
  return info.dli_fname != nullptr ? info.dli_fname : "";
}

std::array<fs::path, 4> folders_of_weights() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return {program.parent_path().parent_path() / HQSLAM_DATA_FOLDER / "hqslam/weights",
          own_file().parent_path() / "share/hqslam/weights", HQSLAM_WEIGHTS_INSTALLED,
          HQSLAM_WEIGHTS_SOURCE};
}

/// The weights files in the first folder that has any whose name `is_wanted`.
std::vector<fs::path> first_weights(const std::function<bool(const std::string&)>& is_wanted) {
  std::vector<fs::path> files;
  for (const fs::path& folder : folders_of_weights()) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      const std::string file = entry.path().filename().string();
      if (file.ends_with(".npz") && is_wanted(file)) files.push_back(entry.path());
    }
    if (!files.empty()) break;
  }
  std::ranges::sort(files);
  return files;
}

/// Whether a weights file of this name is of a kind that SuperResolver::load reads.
bool is_of_a_product_kind(const std::string& file) {
  return std::ranges::any_of(nn::hqs_architectures(), [&](const nn::NamedArchitecture& kind) {
    return file.starts_with(kind.name);
  });
}

}  // namespace

std::vector<std::string> installed_weights_names() {
  std::vector<std::string> names;
  for (const fs::path& file : first_weights(is_of_a_product_kind)) {
    const std::string name = file.filename().string();
    names.push_back(name.substr(0, name.find('_')));
  }
  std::ranges::sort(names);
  names.erase(std::ranges::unique(names).begin(), names.end());
  return names;
}

std::vector<std::string> installed_weights_files(const std::string& name) {
  const std::vector<fs::path> files =
      first_weights([&](const std::string& file) { return file.starts_with(name + '_'); });
  return {files.begin(), files.end()};
}

std::optional<std::string> installed_weights(const std::string& file) {
  for (const fs::path& folder : folders_of_weights()) {
    std::error_code error;
    if (fs::is_regular_file(folder / file, error)) return (folder / file).string();
  }
  return std::nullopt;
}

}  // namespace hqslam::pipeline
