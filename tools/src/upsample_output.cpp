#include "upsample_output.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/pcd.h"
#include "hqslam/core/png.h"
#include "hqslam/core/scan.h"
#include "recording_sensor.h"
#include "result_folder.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kWrittenBy = "hqslam upsample";
constexpr std::array<const char*, 6> kFiles = {"scans.npy",     "confidence.npy", "sensor.json",
                                               "upsample.json", "truth.tum",      "truth.kitti"};
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

bool written_by_upsample(const fs::path& folder) {
  std::ifstream stream(folder / "upsample.json");
  const Json json = Json::parse(stream, nullptr, /*allow_exceptions=*/false);
  return json.is_object() && json.value("written_by", Json()) == kWrittenBy;
}

void clear(const fs::path& folder) {
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw Error(
        fmt::format("{}: expected a folder for the results, found a file; give another --out",
                    folder.string()));
  }
  const bool ours = written_by_upsample(folder);
  std::vector<const char*> names(kFiles.begin(), kFiles.end());
  names.insert(names.end(), kScanFolders.begin(), kScanFolders.end());
  for (const char* name : names) {
    if (fs::exists(folder / name) && !ours) {
      throw Error(fmt::format(
          "{}: is there already and was not written by hqslam upsample; give another --out or move "
          "it",
          (folder / name).string()));
    }
  }
  for (const char* scans : kScanFolders) {
    if (!fs::is_directory(folder / scans)) {
      continue;
    }
    const std::vector<fs::path> files(fs::directory_iterator(folder / scans), {});
    for (const fs::path& file : files) {
      if (file.extension() == std::string(".") + scans) {
        fs::remove(file);
      }
    }
  }
  for (const char* file : kFiles) {
    fs::remove(folder / file);
  }
}

/// `folder`, made empty of earlier results: the members that open files in it start with this.
fs::path prepared(const std::string& folder, const std::string& input) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  refuse_to_overwrite_input(path, input);
  clear(path);
  make_result_folder(path);
  return path;
}

void write_origin(const fs::path& path, const std::string& input, const std::string& method) {
  const Json json = {{"written_by", kWrittenBy}, {"input", input}, {"method", method}};
  std::ofstream stream(path, std::ios::binary);
  stream << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  stream.close();
  if (!stream) {
    throw Error(fmt::format("{}: cannot be written; is the disk full?", path.string()));
  }
}

Scan scan_of(const OrganizedCloud& cloud) {
  Scan scan;
  for (std::size_t pixel = 0; pixel < cloud.points_m.size(); ++pixel) {
    if (cloud.range_m[pixel] > 0.0F) {
      scan.points_m.push_back(cloud.points_m[pixel]);
    }
  }
  return scan;
}

}  // namespace

UpsampleOutput::UpsampleOutput(const std::string& folder, const std::string& input,
                               const std::string& method, const SensorModel& sensor,
                               UpsampledFormats formats)
    : folder_(prepared(folder, input)),
      sensor_(sensor),
      formats_(formats),
      stack_((folder_ / "scans.npy").string(), sensor.rows(), sensor.columns) {
  write_origin(folder_ / "upsample.json", input, method);
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

void UpsampleOutput::append(const RangeImage& image, const OrganizedCloud& cloud) {
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
  const Scan scan = scan_of(cloud);
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
