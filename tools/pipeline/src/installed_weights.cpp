#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <filesystem>
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

/// Whether weights of this name are of a kind that SuperResolver::load reads.
bool is_of_a_product_kind(const std::string& name) {
  return std::ranges::any_of(nn::hqs_architectures(), [&](const nn::NamedArchitecture& kind) {
    return name.starts_with(kind.name);
  });
}

}  // namespace

std::vector<std::string> installed_weights_names() {
  std::vector<std::string> names;
  for (const fs::path& folder : folders_of_weights()) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() != ".npz") continue;
      const std::string file = entry.path().filename().string();
      const std::string name = file.substr(0, file.find('_'));
      if (is_of_a_product_kind(name)) names.push_back(name);
    }
    if (!names.empty()) break;
  }
  std::ranges::sort(names);
  names.erase(std::ranges::unique(names).begin(), names.end());
  return names;
}

std::vector<std::string> installed_weights_files(const std::string& name) {
  std::vector<std::string> files;
  for (const fs::path& folder : folders_of_weights()) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      const std::string file = entry.path().filename().string();
      if (file.ends_with(".npz") && file.starts_with(name + '_')) files.push_back(entry.path());
    }
    if (!files.empty()) break;
  }
  std::ranges::sort(files);
  return files;
}

std::optional<std::string> installed_weights(const std::string& file) {
  for (const fs::path& folder : folders_of_weights()) {
    std::error_code error;
    if (fs::is_regular_file(folder / file, error)) return (folder / file).string();
  }
  return std::nullopt;
}

}  // namespace hqslam::pipeline
