#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"

namespace hqslam {

/// One scan per file, all of one kind, in the order given; without a sensor that which is found in
/// the points. Throws Error.
std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const std::optional<SensorModel>& sensor,
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

}  // namespace hqslam
