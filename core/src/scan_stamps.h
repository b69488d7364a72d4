#pragma once

#include <string>
#include <vector>

namespace hqslam {

/// A stamp per line, in the order of the scans: seconds, or a date as KITTI's timestamps.txt has it
/// (2011-09-26 13:02:25.594360375, taken as UTC). Empty lines and lines that begin with # are
/// passed over. Throws Error with the line, also for a file without a stamp.
std::vector<double> read_stamps_s(const std::string& path);

/// The number in the name of each file: seconds, or nano-, micro- or milliseconds since 1970 by its
/// size. Throws Error for a name without one.
std::vector<double> stamps_from_names_s(const std::vector<std::string>& paths);

}  // namespace hqslam
