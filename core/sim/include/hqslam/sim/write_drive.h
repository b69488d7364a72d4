#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "hqslam/core/npy.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// Writes the file that says what a drive is; read_drive_json reads it. Throws Error.
void write_drive_json(const std::string& path, DriveSpec spec, const SensorModel& sensor);

/// Formats written beside the stack of range images, one file per scan, points as captured (not
/// corrected for motion).
struct ExtraFormats {
  bool kitti_bin = false;  ///< bin/000000.bin, ...
  bool pcd = false;        ///< pcd/000000.pcd, ...
};

/// Writes a drive to a folder, scan by scan; what is there is valid whenever writing stops:
///   scans.npy          N x rows x columns, float32 metres, 0 = no return, row 0 the highest beam
///   sensor.json        the sensor model
///   drive.json         name, seed and planned length of the drive, and the simulator's revision;
///                      mount and conditions where they are not the usual ones
///   truth.tum          true pose of every scan at its stamp, in the frame of the first scan
///   truth.kitti        the same as KITTI writes it
///   truth_columns.npy  N x columns x 7, float64: x y z qx qy qz qw when the head is at each column
/// Throws Error if the folder cannot be made or a file cannot be written.
class DriveWriter {
 public:
  DriveWriter(const std::string& directory, const DriveSpec& spec, const SensorModel& sensor,
              ExtraFormats extra = {});
  void append(const SimulatedScan& scan);

 private:
  void write_extra(const RangeImage& image) const;

  std::string directory_;
  SensorModel sensor_;
  ExtraFormats extra_;
  std::int64_t scans_ = 0;
  NpyStackWriter stack_;
  NpyArrayWriter<double> columns_;
  std::ofstream tum_;
  std::ofstream kitti_;
};

}  // namespace hqslam::sim
