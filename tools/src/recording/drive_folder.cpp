#include "recording/drive_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/sim/read_drive.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 9> kDriveFiles = {
    "scans.npy",         "sensor.json",        "drive.json", "truth.tum",     "truth.kitti",
    "truth_columns.npy", "sensor_errors.json", "imu.csv",    "imu_biases.csv"};
constexpr std::string_view kMarkerFile = "drive.json";  // is replaced, not removed
constexpr std::array<const char*, 2> kScanFolders = {"bin", "pcd"};

/// The file that says what the drive is comes first: it marks the folder however little else is
/// there, because a disk was full or the program was killed.
bool written_by_simulate(const fs::path& folder) {
  try {
    sim::read_drive_json((folder / "drive.json").string());
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// bin/000123.bin, pcd/000123.pcd, and what a program that was killed left of one
bool is_numbered_scan(fs::path file, const std::string& extension) {
  if (file.extension() == ".part") file.replace_extension();
  const std::string stem = file.stem().string();
  return file.extension() == "." + extension && stem.size() >= 6 &&
         std::all_of(stem.begin(), stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

void remove_numbered_scans(const fs::path& folder, const std::string& extension) {
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

void clear_drive_folder(const std::string& folder, const Paths& inputs, bool is_own) {
  const fs::path path(folder);
  is_own = is_own || written_by_simulate(path);
  constexpr const char* kBut = "is not part of a simulated drive";
  guard_results(path, kDriveFiles, is_own, kBut, inputs);
  for (const char* scans : kScanFolders) {
    if (!is_own && fs::exists(path / scans)) guard_results(path, {&scans, 1}, false, kBut);
  }
  for (const char* scans : kScanFolders) remove_numbered_scans(path / scans, scans);
  for (const char* file : kDriveFiles) {
    if (file != kMarkerFile) fs::remove(path / file);
  }
}

}  // namespace hqslam::tools
