#pragma once

#include <cstdint>
#include <string>

#include "hqslam/core/npy.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// Writes the specification of a drive; read_drive_json reads it. Throws Error.
void write_drive_json(const std::string& path, DriveSpec spec, const SensorModel& sensor);

/// Files beside the stack of range images: the points of each scan as captured (not corrected for
/// motion) with their intensities, and the samples of an inertial sensor.
struct ExtraFormats {
  bool kitti_bin = false;  ///< bin/000000.bin, ...
  bool pcd = false;        ///< pcd/000000.pcd, ...
  bool imu = false;        ///< imu.csv
};

/// Writes a drive to a folder, scan by scan; the files are valid whenever writing stops:
///   scans.npy          N x rows x columns, float32 metres, 0 = no return, row 0 the highest beam
///   intensity.npy      N x rows x columns, bytes: SimulatedScan::intensity
///   sensor.json        the sensor model
///   drive.json         name, seed and planned length of the drive, and the simulator's revision;
///                      mount, conditions and sensor errors where they are not the usual ones
///   imu.csv            with ExtraFormats::imu: 100 samples a second (ImuSample)
///   sensor_errors.json where the sensor has any: of each beam range_m (reported minus true),
///                      elevation_deg and azimuth_deg (true minus sensor.json's)
///   truth.tum          true pose of every scan at its stamp, in the frame of the first scan
///   truth.kitti        these poses in KITTI's format
///   truth_columns.npy  N x columns x 7, float64: x y z qx qy qz qw when the head is at each column
/// Throws Error if the folder cannot be made or a file cannot be written.
class DriveWriter {
 public:
  DriveWriter(const std::string& directory, const DriveSpec& spec, const SensorModel& sensor,
              ExtraFormats extra = {});
  void append(const SimulatedScan& scan);

 private:
  void write_extra(const SimulatedScan& scan) const;
  void append_imu(const std::vector<SimulatedImuSample>& samples) const;
  /// The text is on the disk at once, so that the file is valid whenever the program stops.
  void append_text(const char* name, const std::string& text) const;

  std::string directory_;
  SensorModel sensor_;
  ExtraFormats extra_;
  std::int64_t scans_ = 0;
  NpyStackWriter stack_;
  NpyArrayWriter<std::uint8_t> intensity_;
  NpyArrayWriter<double> columns_;
};

}  // namespace hqslam::sim
