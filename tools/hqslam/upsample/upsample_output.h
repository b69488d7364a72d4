#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "files/result_files.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::tools {

/// Formats written beside the stack of range images, one file per scan.
struct UpsampledFormats {
  bool kitti_bin = false;  ///< bin/000000.bin, ...
  bool pcd = false;        ///< pcd/000000.pcd, ...
};

/// Where the scans of a folder come from.
struct UpsampleOrigin {
  std::string input;
  std::string method;
  std::optional<std::int64_t> scans = {};  ///< of the recording; nothing: not known yet
  std::string poses = {};                  ///< the file of poses for recall; or empty
};

/// The folder that `hqslam upsample` writes into, scan by scan; what is there is valid whenever
/// writing stops:
///   scans.npy      N x rows x columns, float32 metres, 0 = no return, row 0 the highest beam
///   confidence.npy  N x rows x columns, float32, 0 to 1, if the method gives a confidence
///   intensity.npy  the same shape, float32, if the recording has intensities; not a number where
///                  that of a return is not known
///   timestamps.txt  the stamp of each scan, seconds
///   first_columns.txt  where the turn of each scan begins, if not all begin at column 0
///   sensor.json    the sensor model
///   upsample.json  where the scans came from, and whether all of them did
///   truth.tum, truth.kitti  those of the drive that was upsampled, if it has any
class UpsampleOutput {
 public:
  /// Removes what an earlier `hqslam upsample` wrote into the folder. Throws Error, touching
  /// nothing, if `input` is one of the files that would be written, or if one of them is there and
  /// is not hqslam upsample's.
  UpsampleOutput(const std::string& folder, UpsampleOrigin origin, const SensorModel& sensor,
                 UpsampledFormats formats);

  /// cloud: the same scan as points. Throws Error.
  void append(const RangeImage& image, const OrganizedCloud& cloud, double stamp_s);
  /// Marks upsample.json as complete, with the number of scans of the recording.
  /// Throws Error.
  void finish(std::int64_t scans);

 private:
  void append_line(std::ofstream& file, const char* name, const std::string& line) const;
  void append_first_column(int column);
  void append_beside(std::optional<NpyStackWriter>& stack, const char* name,
                     const std::vector<float>& values) const;
  void write_formats(const OrganizedCloud& cloud, double stamp_s, PartFiles& parts) const;

  std::filesystem::path folder_;
  FolderLock lock_;
  UpsampleOrigin origin_;
  SensorModel sensor_;
  UpsampledFormats formats_;
  NpyStackWriter stack_;
  std::ofstream stamps_;
  std::ofstream first_columns_;
  std::optional<NpyStackWriter> confidence_;
  std::optional<NpyStackWriter> intensity_;
  std::int64_t scans_ = 0;
};

}  // namespace hqslam::tools
