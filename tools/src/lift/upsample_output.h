#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "files/result_folder.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::tools {

/// Formats written beside the stack of range images, one file per scan.
struct UpsampledFormats {
  bool kitti_bin = false;  ///< bin/000000.bin, ...
  bool pcd = false;        ///< pcd/000000.pcd, ...
  bool png = false;        ///< png/000000.png, ...: the range image in colours
};

/// The folder that `hqslam upsample` writes into, scan by scan; what is there is valid whenever
/// writing stops:
///   scans.npy      N x rows x columns, float32 metres, 0 = no return, row 0 the highest beam
///   confidence.npy  N x rows x columns, float32, 0 to 1, if the method says how sure it is
///   timestamps.txt  the stamp of each scan, seconds
///   sensor.json    the sensor model
///   upsample.json  where the scans came from
///   truth.tum, truth.kitti  those of the drive that was upsampled, if it has any
class UpsampleOutput {
 public:
  /// Removes what an earlier `hqslam upsample` wrote into the folder. Throws Error, touching
  /// nothing, if `input` is one of the files that would be written, or if one of them is there and
  /// is not hqslam upsample's.
  UpsampleOutput(const std::string& folder, const std::string& input, const std::string& method,
                 const SensorModel& sensor, UpsampledFormats formats);

  /// cloud: the same scan as points. Throws Error.
  void append(const RangeImage& image, const OrganizedCloud& cloud, double stamp_s);

 private:
  void write_formats(const RangeImage& image, const OrganizedCloud& cloud) const;

  std::filesystem::path folder_;
  FolderLock lock_;
  SensorModel sensor_;
  UpsampledFormats formats_;
  NpyStackWriter stack_;
  std::ofstream stamps_;
  std::optional<NpyStackWriter> confidence_;
  std::int64_t scans_ = 0;
};

}  // namespace hqslam::tools
