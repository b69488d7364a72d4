#include "upsample/upsample_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "hqslam/core/cloud_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/projection.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kWrittenBy = "hqslam upsample";
constexpr const char* kMarker = "\"written_by\": \"hqslam upsample\"";
constexpr const char* kMarkerFile = "upsample.json";
constexpr const char* kStampsFile = "timestamps.txt";
constexpr const char* kFirstColumnsFile = "first_columns.txt";
constexpr std::array<const char*, 10> kFiles = {
    "scans.npy",   "confidence.npy", "intensity.npy", kStampsFile,   kFirstColumnsFile,
    "sensor.json", "upsample.json",  "truth.tum",     "truth.kitti", "imu.csv"};
constexpr std::array<const char*, 3> kFilesOfDrive = {"truth.tum", "truth.kitti", "imu.csv"};
constexpr std::array<const char*, 2> kScanFolders = {"bin", "pcd"};
constexpr ScanFolder kUpsampled{kFiles, kScanFolders, kMarkerFile};

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

void refuse_to_overwrite_input(const fs::path& folder, const std::string& input) {
  const fs::path from = fs::absolute(input).lexically_normal();
  bool overwrites = same_file(folder, from);
  for (const char* file : kFiles) overwrites = overwrites || same_file(folder / file, from);
  for (const char* scans : kScanFolders) {
    overwrites = overwrites || same_file(folder / scans, from) ||
                 same_file(folder / scans, from.parent_path());
  }
  if (overwrites) {
    throw Error("{}: would be overwritten; give another --out", input);
  }
}

/// `folder`, made if it is not there: the lock on it comes next.
fs::path made(const std::string& folder, const std::string& input) {
  fs::path path = fs::absolute(folder).lexically_normal();
  refuse_to_overwrite_input(path, input);
  make_result_folder(path);
  return path;
}

void write_origin(const fs::path& folder, const UpsampleOrigin& origin, bool complete) {
  Json json = {{"written_by", kWrittenBy}, {"input", origin.input}, {"method", origin.method}};
  json["scans_in_recording"] = origin.scans ? Json(*origin.scans) : Json();
  if (!origin.poses.empty()) json["poses"] = origin.poses;
  json["complete"] = complete;
  write_text_file(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
                  (folder / kMarkerFile).string());
}

/// `folder`, made empty of earlier results: the members that open files in it start with this. The
/// file with the origin of the results is first: it marks the folder as ours however little
/// else is there, because a disk was full or the program was killed.
fs::path prepared(const fs::path& folder, const UpsampleOrigin& origin) {
  guard_scan_folder(folder, kUpsampled, has_marker((folder / kMarkerFile).string(), kMarker),
                    "was not written by hqslam upsample");
  write_origin(folder, origin, false);
  clear_scan_folder(folder, kUpsampled);
  return folder;
}

}  // namespace

UpsampleOutput::UpsampleOutput(const std::string& folder, UpsampleOrigin origin,
                               const SensorModel& sensor, UpsampledFormats formats)
    : folder_(made(folder, origin.input)),
      lock_(folder_),
      origin_(std::move(origin)),
      sensor_(sensor),
      formats_(formats),
      stack_((prepared(folder_, origin_) / "scans.npy").string(), sensor.rows(), sensor.columns),
      stamps_(folder_ / kStampsFile) {
  write_sensor_json(sensor, (folder_ / "sensor.json").string());
  for (const char* file : kFilesOfDrive) {
    if (const std::string known = file_of_drive(origin_.input, file); !known.empty()) {
      fs::copy_file(known, folder_ / file);
    }
  }
  if (formats.kitti_bin) make_result_folder(folder_ / "bin");
  if (formats.pcd) make_result_folder(folder_ / "pcd");
}

void UpsampleOutput::append(const RangeImage& image, const OrganizedCloud& cloud, double stamp_s) {
  // A stack may have fewer images than there are stamps, a folder of scans may not: its files get
  // their names when all else is there, so that a program that is killed leaves what can be read.
  PartFiles parts;
  write_formats(cloud, stamp_s, parts);
  append_line(stamps_, kStampsFile, fmt::format("{:.9f}\n", stamp_s));
  append_first_column(first_column(cloud, sensor_));
  append_beside(confidence_, "confidence.npy", cloud.confidence);
  append_beside(intensity_, "intensity.npy", cloud.intensity);
  stack_.append(image);
  parts.rename();
  ++scans_;
}

void UpsampleOutput::append_line(std::ofstream& file, const char* name,
                                 const std::string& line) const {
  if (file.write(line.data(), std::ssize(line)).flush()) return;
  throw Error("{}: cannot be written: the disk may be full", (folder_ / name).string());
}

/// The file is there from the first scan that does not begin at column 0.
void UpsampleOutput::append_first_column(int column) {
  if (column == 0 && !first_columns_.is_open()) return;
  if (!first_columns_.is_open()) {
    first_columns_.open(folder_ / kFirstColumnsFile);
    for (std::int64_t scan = 0; scan < scans_; ++scan) {
      append_line(first_columns_, kFirstColumnsFile, "0\n");
    }
  }
  append_line(first_columns_, kFirstColumnsFile, fmt::format("{}\n", column));
}

/// Before the image itself: none may be without. Of scans that have no values none is known.
void UpsampleOutput::append_beside(std::optional<NpyStackWriter>& stack, const char* name,
                                   const std::vector<float>& values) const {
  if (values.empty() && !stack) return;
  RangeImage image(sensor_.rows(), sensor_.columns);
  std::ranges::fill(image.range_m, std::numeric_limits<float>::quiet_NaN());
  if (!stack) {
    stack.emplace((folder_ / name).string(), image.rows, image.columns);
    for (std::int64_t scan = 0; scan < scans_; ++scan) stack->append(image);
  }
  if (!values.empty()) image.range_m = values;
  stack->append(image);
}

void UpsampleOutput::finish(std::int64_t scans) {
  origin_.scans = scans;
  write_origin(folder_, origin_, true);
}

void UpsampleOutput::write_formats(const OrganizedCloud& cloud, double stamp_s,
                                   PartFiles& parts) const {
  const auto part = [&](const char* kind) {
    return parts.add(folder_ / kind / fmt::format("{:06}.{}", scans_, kind));
  };
  if (!formats_.kitti_bin && !formats_.pcd) return;
  Scan scan = returns_of(cloud);
  scan.stamp_s = stamp_s;
  if (formats_.kitti_bin) write_kitti_bin(scan, part("bin"));
  if (!formats_.pcd) return;
  if (scan.intensity.empty()) {  // then it is the image's points alone
    scan.row.clear();
    scan.time_offset_s.clear();
  }
  write_cloud(scan, part("pcd"));
}

}  // namespace hqslam::tools
