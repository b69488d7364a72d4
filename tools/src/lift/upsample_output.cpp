#include "lift/upsample_output.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <vector>

#include "files/text_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/pcd.h"
#include "hqslam/core/scan.h"
#include "hqslam/evaluation/png.h"
#include "recording/drive_folder.h"
#include "recording/recording_sensor.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kWrittenBy = "hqslam upsample";
constexpr const char* kMarker = "\"written_by\": \"hqslam upsample\"";
constexpr std::string_view kMarkerFile = "upsample.json";  // is replaced, not removed
constexpr const char* kStampsFile = "timestamps.txt";
constexpr std::array<const char*, 7> kFiles = {"scans.npy",   "confidence.npy", kStampsFile,
                                               "sensor.json", "upsample.json",  "truth.tum",
                                               "truth.kitti"};
constexpr std::array<const char*, 2> kTruthFiles = {"truth.tum", "truth.kitti"};
constexpr std::array<const char*, 3> kScanFolders = {"bin", "pcd", "png"};

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

void refuse_to_overwrite_input(const fs::path& folder, const std::string& input) {
  const fs::path from = fs::absolute(input).lexically_normal();
  bool overwrites = same_file(folder, from);
  for (const char* file : kFiles) {
    overwrites = overwrites || same_file(folder / file, from);
  }
  for (const char* scans : kScanFolders) {
    overwrites = overwrites || same_file(folder / scans, from) ||
                 same_file(folder / scans, from.parent_path());
  }
  if (overwrites) {
    throw Error(fmt::format("{}: would be overwritten; give another --out", input));
  }
}

/// Throws Error if something in the folder would be replaced that hqslam upsample did not write.
void refuse_foreign_results(const fs::path& folder) {
  if (has_marker((folder / kMarkerFile).string(), kMarker)) return;
  refuse_existing(folder, kFiles, "and was not written by hqslam upsample");
  refuse_existing(folder, kScanFolders, "and was not written by hqslam upsample");
}

void remove_results(const fs::path& folder) {
  for (const char* scans : kScanFolders) remove_numbered_scans(folder / scans, scans);
  for (const char* file : kFiles) {
    if (file != kMarkerFile) fs::remove(folder / file);
  }
}

/// `folder`, made if it is not there: the lock on it comes next.
fs::path made(const std::string& folder, const std::string& input) {
  fs::path path = fs::absolute(folder).lexically_normal();
  refuse_to_overwrite_input(path, input);
  make_result_folder(path);
  return path;
}

/// `folder`, made empty of earlier results: the members that open files in it start with this. The
/// file that says where the results came from is first: it marks the folder as ours however little
/// else is there, because a disk was full or the program was killed.
fs::path prepared(const fs::path& folder, const std::string& input, const std::string& method) {
  refuse_foreign_results(folder);
  const Json origin = {{"written_by", kWrittenBy}, {"input", input}, {"method", method}};
  write_text_file(origin.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
                  (folder / kMarkerFile).string());
  remove_results(folder);
  return folder;
}

}  // namespace

UpsampleOutput::UpsampleOutput(const std::string& folder, const std::string& input,
                               const std::string& method, const SensorModel& sensor,
                               UpsampledFormats formats)
    : folder_(made(folder, input)),
      lock_(folder_),
      sensor_(sensor),
      formats_(formats),
      stack_((prepared(folder_, input, method) / "scans.npy").string(), sensor.rows(),
             sensor.columns),
      stamps_(folder_ / kStampsFile) {
  write_sensor_json(sensor, (folder_ / "sensor.json").string());
  for (const char* truth : kTruthFiles) {
    if (const std::string known = file_of_drive(input, truth); !known.empty()) {
      fs::copy_file(known, folder_ / truth);
    }
  }
  const std::array<bool, 3> wanted = {formats.kitti_bin, formats.pcd, formats.png};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i]) {
      make_result_folder(folder_ / kScanFolders[i]);
    }
  }
}

void UpsampleOutput::append(const RangeImage& image, const OrganizedCloud& cloud, double stamp_s) {
  // First, because a stack may have fewer images than there are stamps.
  const std::string line = fmt::format("{:.9f}\n", stamp_s);
  if (!stamps_.write(line.data(), std::ssize(line)).flush()) {
    throw Error(
        fmt::format("{}: cannot be written; is the disk full?", (folder_ / kStampsFile).string()));
  }
  stack_.append(image);
  if (!cloud.confidence.empty()) {
    if (!confidence_) {
      confidence_.emplace((folder_ / "confidence.npy").string(), sensor_.rows(), sensor_.columns);
    }
    RangeImage confidence = image;
    confidence.range_m = cloud.confidence;
    confidence_->append(confidence);
  }
  write_formats(image, cloud);
  ++scans_;
}

void UpsampleOutput::write_formats(const RangeImage& image, const OrganizedCloud& cloud) const {
  const auto path = [&](const char* kind) {
    return (folder_ / kind / fmt::format("{:06}.{}", scans_, kind)).string();
  };
  if (formats_.png) {
    write_png(color_by_range(image, sensor_.max_range_m), path("png"));
  }
  if (!formats_.kitti_bin && !formats_.pcd) {
    return;
  }
  Scan scan;
  scan.points_m = points_of(cloud);
  if (formats_.kitti_bin) {
    write_kitti_bin(scan, path("bin"));
  }
  if (formats_.pcd) {
    std::vector<float> confidence;
    for (std::size_t pixel = 0; pixel < cloud.confidence.size(); ++pixel) {
      if (cloud.range_m[pixel] > 0.0F) confidence.push_back(cloud.confidence[pixel]);
    }
    write_pcd(scan.points_m, path("pcd"), confidence);
  }
}

}  // namespace hqslam::tools
