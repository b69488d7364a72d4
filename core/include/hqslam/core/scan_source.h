#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One scan of a recording, ready for SLAM or upsampling.
struct RecordedScan {
  std::string name;  ///< the file, or the stack and the index in it
  double stamp_s = 0.0;
  OrganizedCloud cloud;
  std::int64_t invalid_points = 0;  ///< not finite or at the origin: dropped
  ProjectionCounts counts;
  std::vector<ImuSample> imu;  ///< since the scan before, up to the end of this one
};

/// A recording read once, scan by scan; never more than its first few scans in memory.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  virtual const SensorModel& sensor() const = 0;
  /// How many scans there are; nothing where only reading them all tells.
  virtual std::optional<std::int64_t> size() const = 0;
  /// How much of the recording was read, 0 to 1.
  virtual double read_share() const = 0;
  /// Whether its stamps are its own; otherwise they are counted in the sensor's periods from 0 s.
  virtual bool has_stamps() const = 0;
  /// The next scan, or nothing at the end. Throws ScanError for a scan that cannot be understood,
  /// after which the next one can be asked for, and Error where the recording cannot be read on.
  virtual std::optional<RecordedScan> next() = 0;
  /// What whoever uses the recording should know of it, a line each; complete when all scans were
  /// read.
  virtual std::vector<std::string> warnings() const { return {}; }
};

/// Where row 0 of the images in an .npy stack looks.
enum class RowOrder { kHighestFirst, kLowestFirst };

struct RecordingOptions {
  RowOrder row_order = RowOrder::kHighestFirst;
  /// Whether a stack's scans were captured rolling or were corrected for motion already; they are
  /// taken as corrected too if the sensor's model says so.
  CaptureTime capture_time = CaptureTime::kRolling;
  /// How points of files that have no times were captured: rolling gives each the time of its
  /// azimuth, for points in the order of their firing or ring after ring, and a scan without a
  /// stamp the middle of these as its stamp, counted on from scan to scan. Nothing: they are taken
  /// as corrected for motion, and a warning says so.
  std::optional<CaptureTime> without_times = std::nullopt;
  /// A file with the stamp of each scan (seconds, or dates as in KITTI's timestamps.txt), or
  /// kStampsFromNames for the number in each file's name. Empty: what the recording says.
  std::string stamps = {};
};

/// For RecordingOptions::stamps.
inline constexpr const char* kStampsFromNames = "names";

/// Opens a recording of `sensor`; without one, of that of its sensor.json or that which its points
/// tell of, and a warning says which that is:
/// - a folder of KITTI .bin files (motion-corrected; rows from the rings where the points are
///   stored ring after ring, from the elevation otherwise), or a KITTI drive with them in
///   `velodyne` or `velodyne_points/data`;
/// - a folder of .pcd, .ply, .txt or .csv files (rows from rings, times from a field of
/// times);
/// - one such file: a recording of one scan;
/// - an .npy stack of range images (N x H x W or N x H x W x 1, float32 metres; `options` apply);
/// - a folder written by `hqslam-lab simulate` or `hqslam upsample` (scans.npy, sensor.json;
/// `options`
///   apply), with confidence and intensity of its pixels if there is a confidence.npy or an
///   intensity.npy (float32, or bytes): what its sensor.json says of measured rows and of the
///   correction for motion holds, whatever `sensor` says.
/// Files are taken in the natural order of their names. The stamp of a scan is what options.stamps
/// says, else that of a timestamps.txt in the folder or, beside files, the one above it (KITTI's
/// drives), else the middle of its points' times where those are a clock's or as
/// options.without_times says, else its index times sensor.scan_period_s. A unit whose beams are
/// off the sensor's by up to 1.5 degrees is read with its own, estimated from its first scans. In a
/// folder of images with truth.tum and no timestamps.txt the stamps are those of truth.tum: (index
/// + 1/2) times the period for a simulated drive, the middle of each scan. Pixels of images that
/// are not finite or negative count as invalid points. Throws Error: which file, what was expected,
/// what was found, what to do; also for scans that cannot be the sensor's.
std::unique_ptr<ScanSource> open_scan_files(const std::string& path,
                                            const std::optional<SensorModel>& sensor,
                                            const RecordingOptions& options = {});

/// A recording with inertial samples that were kept elsewhere, in the order of their stamps, in
/// place of its own. Once most of the scans that were read have none, as by another clock, its
/// warnings end with one that says so; `name` stands for the samples in it.
std::unique_ptr<ScanSource> with_imu(std::unique_ptr<ScanSource> source,
                                     std::vector<ImuSample> samples,
                                     const std::string& name = "inertial data");

}  // namespace hqslam
