#include "files/result_files.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>

#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"

namespace hqslam::tools {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw Error("{}: is there already and {}; give another --out or move it", path.string(), why);
}

std::filesystem::path part_of(std::filesystem::path path) { return path += ".part"; }

constexpr std::array<const char*, 9> kDriveFiles = {
    "scans.npy",   "intensity.npy",     "sensor.json",        "drive.json", "truth.tum",
    "truth.kitti", "truth_columns.npy", "sensor_errors.json", "imu.csv"};
constexpr std::array<const char*, 2> kScanFolders = {"bin", "pcd"};
constexpr ScanFolder kDrive{kDriveFiles, kScanFolders, "drive.json"};

/// The file that describes the drive comes first: it marks the folder however little else is
/// there, because a disk was full or the program was killed.
bool written_by_simulate(const fs::path& folder) {
  return scans_of_simulated_drive((folder / "drive.json").string()).has_value();
}

/// bin/000123.bin, pcd/000123.pcd, and what a program that was killed left of one
bool is_numbered_scan(fs::path file, const std::string& extension) {
  if (file.extension() == ".part") file.replace_extension();
  const std::string stem = file.stem().string();
  return file.extension() == "." + extension && stem.size() >= 6 &&
         std::ranges::all_of(stem, [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Removes 000000.EXTENSION, 000001.EXTENSION and so on, and no other file.
void remove_numbered_scans(const fs::path& folder, const std::string& extension) {
  if (!fs::is_directory(folder)) return;
  std::vector<fs::path> scans;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_numbered_scan(entry.path(), extension)) scans.push_back(entry.path());
  }
  for (const fs::path& scan : scans) fs::remove(scan);
}

}  // namespace

void refuse_to_replace(const fs::path& file, const Paths& inputs) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) {
    if (fs::is_symlink(file, error)) refuse(file, "is a link that leads nowhere");
    return;
  }
  if (!fs::is_regular_file(status)) {
    refuse(file, fs::is_directory(status) ? "is a folder" : "is no regular file");
  }
  for (const std::string& input : inputs) {
    if (!fs::equivalent(file, input, error) || error) continue;
    throw Error("{}: is read by this command and would be replaced; give another --out", input);
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
    throw Error("{}: expected an existing folder to write it into, found none; make {}", path,
                folder.string());
  }
  refuse_to_replace(path, inputs);
  if (fs::exists(path, error) && !is_own(path)) refuse(path, "was not written by this command");
  require_writable(folder);
}

void guard_output_file(const std::string& path, const Paths& inputs, const std::string& marker) {
  guard_output_file(path, inputs,
                    [&](const std::string& there) { return has_marker(there, marker); });
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

void make_result_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored)) {
    throw Error("{}: cannot be made as a folder for the results ({}); give another --out",
                folder.string(), error.message());
  }
  require_writable(folder);
}

void require_writable(const std::filesystem::path& folder) {
  const std::filesystem::path probe = folder / ".hqslam-probe";
  if (!std::ofstream(probe)) {
    throw Error("{}: no file can be written there; give another --out", folder.string());
  }
  std::error_code ignored;
  std::filesystem::remove(probe, ignored);
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (!descriptor_ || flock(descriptor_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
    return;
  }
  throw Error(
      "{}: another hqslam is writing into it; wait until it has ended, or give another --out",
      folder.string());
}

void remove_results(const fs::path& folder, std::span<const char* const> names) {
  std::error_code ignored;
  for (const char* name : names) {
    fs::remove(folder / name, ignored);
    fs::remove(part_of(folder / name), ignored);
  }
}

RemovedAtEnd::~RemovedAtEnd() {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

PartFiles::~PartFiles() {
  std::error_code ignored;
  for (const std::filesystem::path& path : paths_) std::filesystem::remove(part_of(path), ignored);
}

std::string PartFiles::add(const std::filesystem::path& path) {
  paths_.push_back(path);
  return part_of(path).string();
}

void PartFiles::rename() {
  for (const std::filesystem::path& path : paths_) {
    std::error_code error;
    std::filesystem::rename(part_of(path), path, error);
    if (error) throw Error("{}: cannot be written ({})", path.string(), error.message());
  }
}

void write_text_file(const std::string& text, const std::string& path) {
  replace_file(path, [&](const std::string& part) { write_whole_file(part, text); });
}

void guard_scan_folder(const fs::path& folder, const ScanFolder& names, bool is_own,
                       const std::string& but, const Paths& inputs) {
  guard_results(folder, names.files, is_own, but, inputs);
  for (const char* scans : names.scan_folders) {
    if (!is_own && fs::exists(folder / scans)) guard_results(folder, {&scans, 1}, false, but);
  }
}

void clear_scan_folder(const fs::path& folder, const ScanFolder& names) {
  for (const char* scans : names.scan_folders) remove_numbered_scans(folder / scans, scans);
  for (const char* file : names.files) {
    if (file != names.marker) fs::remove(folder / file);
  }
}

void clear_drive_folder(const std::string& folder, const Paths& inputs) {
  guard_scan_folder(folder, kDrive, written_by_simulate(folder), "is not part of a simulated drive",
                    inputs);
  clear_scan_folder(folder, kDrive);
}

std::optional<std::int64_t> scans_of_simulated_drive(const std::string& drive_json) {
  constexpr std::size_t kMostBytes = 1U << 16U;
  try {
    JsonFields fields(whole_file(drive_json, "a drive.json", kMostBytes), drive_json);
    static_cast<void>(fields.text("name"));
    static_cast<void>(fields.unsigned_integer("seed"));
    return fields.integer("scans");
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace hqslam::tools
