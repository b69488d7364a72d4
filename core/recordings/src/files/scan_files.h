#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/recordings/recording.h"
#include "points/sensor_finder.h"

namespace hqslam::recordings {

/// The end of the warning about points without times. inspect() is what `hqslam info` does first,
/// so it leaves that warning out.
inline constexpr const char* kTestedByInfo =
    "'hqslam info' tests whether they are, --capture states it";

/// Which sensor points are read with; `find` determines it from them, once, and throws Error where
/// they do not.
using ChooseSensor = std::function<FoundSensor(const std::function<FoundSensor()>& find)>;

/// Opens a recording; `choose` chooses the sensor of points, `sensor` is that of images, without
/// one that of their sensor.json:
/// - a folder of KITTI .bin files (motion-corrected; rows from the rings where the points are
///   stored ring after ring, from the elevation otherwise), or a KITTI drive with them in
///   `velodyne` or `velodyne_points/data`;
/// - a folder of .pcd, .ply, .txt or .csv files (rows from rings, times from a field of times);
/// - one such file: a recording of one scan;
/// - an .npy stack of range images (N x H x W or N x H x W x 1, float32 metres; `options` apply);
/// - a folder written by `hqslam-lab simulate` or `hqslam upsample` (scans.npy, sensor.json;
///   `options` apply), with confidence and intensity of its pixels if there is a confidence.npy or
///   an intensity.npy (float32, or bytes): the measured rows and the correction for motion of
///   its sensor.json take precedence over those of `sensor`.
/// Files are taken in the natural order of their names. The stamp of a scan is that of
/// options.stamps, else that of a timestamps.txt in the folder or, beside files, the one above it
/// (KITTI's drives), else the middle of its points' times where those are a clock's or of its
/// azimuths by options.capture, else its index times sensor.scan_period_s, where scans that are
/// missing between numbered files count. In a folder of images with truth.tum and no
/// timestamps.txt the stamps are those of truth.tum: (index + 1/2) times the period for a simulated
/// drive, the middle of each scan. Pixels of images that are not finite or negative count as
/// invalid points. Throws Error: which file, what was expected, what was found, what to do; also
/// for scans that cannot be the sensor's.
std::unique_ptr<ScanSource> open_scan_files(const std::string& path,
                                            const std::optional<SensorModel>& sensor,
                                            const ChooseSensor& choose,
                                            const RecordingOptions& options);

/// A recording with inertial samples that were kept elsewhere, in the order of their stamps, in
/// place of its own. Once most of the scans that were read have none, as by another clock, its
/// warnings end with one that states it; `name` stands for the samples in it.
std::unique_ptr<ScanSource> with_imu(std::unique_ptr<ScanSource> source,
                                     std::vector<ImuSample> samples,
                                     const std::string& name = "inertial data");

/// One scan per file, all of one kind, in the order given. Throws Error.
std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const ChooseSensor& choose,
                                                  const RecordingOptions& options);

/// The images of an .npy stack. Image i is of stamps_s[i]; without any stamps, of i scan periods.
/// of_folder: what there is beside it of confidence.npy (of every pixel, 0 to 1) and intensity.npy
/// belongs to it. Throws Error if the shape of any is not that of the sensor, if there are fewer of
/// these than images, or if more than the last image has no stamp.
std::unique_ptr<ScanSource> make_image_stack_source(const std::string& path,
                                                    const SensorModel& sensor,
                                                    const RecordingOptions& options,
                                                    std::vector<double> stamps_s = {},
                                                    bool of_folder = false);

/// A stamp per line, in the order of the scans: seconds, or a date as KITTI's timestamps.txt has it
/// (2011-09-26 13:02:25.594360375, taken as UTC). Empty lines and lines that begin with # are
/// passed over. Throws Error with the line, also for a file without a stamp.
std::vector<double> read_stamps_s(const std::string& path);

/// The number in the name of each file: seconds, or nano-, micro- or milliseconds since 1970 by its
/// size. Throws Error for a name without one.
std::vector<double> stamps_from_names_s(const std::vector<std::string>& paths);

/// RecordingOptions::stamps where it is the seconds from scan to scan.
std::optional<double> stamp_spacing_s(const std::string& wanted);

/// The numbers of scans in the names of their files where some are missing, as of every third scan:
/// they rise, somewhere by more than 1, and somewhere by 10 at most (else they may be a clock's).
/// Empty otherwise.
std::vector<std::size_t> numbers_with_gaps(const std::vector<std::string>& paths);

}  // namespace hqslam::recordings
