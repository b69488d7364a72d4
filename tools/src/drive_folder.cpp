#include "drive_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <vector>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 6> kDriveFiles = {
    "scans.npy", "sensor.json", "drive.json", "truth.tum", "truth.kitti", "truth_columns.npy"};
constexpr std::array<const char*, 2> kScanFolders = {"bin", "pcd"};

bool written_by_simulate(const fs::path& folder) {
  return fs::is_regular_file(folder / "drive.json") &&
         fs::is_regular_file(folder / "truth_columns.npy");
}

/// bin/000123.bin, pcd/000123.pcd
bool is_numbered_scan(const fs::path& file, const std::string& extension) {
  const std::string stem = file.stem().string();
  return file.extension() == "." + extension && stem.size() >= 6 &&
         std::all_of(stem.begin(), stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

void remove_scans(const fs::path& folder, const std::string& extension) {
  if (!fs::is_directory(folder)) {
    return;
  }
  std::vector<fs::path> scans;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_numbered_scan(entry.path(), extension)) {
      scans.push_back(entry.path());
    }
  }
  for (const fs::path& scan : scans) {
    fs::remove(scan);
  }
}

}  // namespace

void clear_drive_folder(const std::string& folder) {
  const fs::path path(folder);
  if (written_by_simulate(path)) {
    for (const char* scans : kScanFolders) {
      remove_scans(path / scans, scans);
    }
    for (const char* file : kDriveFiles) {
      fs::remove(path / file);
    }
    return;
  }
  std::vector<const char*> names(kDriveFiles.begin(), kDriveFiles.end());
  names.insert(names.end(), kScanFolders.begin(), kScanFolders.end());
  for (const char* name : names) {
    if (fs::exists(path / name)) {
      throw Error(fmt::format(
          "{}: is there already and not part of a simulated drive; give another --out or move it",
          (path / name).string()));
    }
  }
}

}  // namespace hqslam::tools
