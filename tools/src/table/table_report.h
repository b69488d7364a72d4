#pragma once

#include <string>
#include <vector>

#include "table/error_map.h"
#include "table/table_figures.h"

namespace hqslam::tools {

/// The trajectories of a drive's methods against LiDAR-64's; nothing in it if that is not there.
ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing);

/// table.html: a page that needs no other file. Tables, error maps and error over distance.
std::string table_html(const std::vector<DriveFigures>& drives);

}  // namespace hqslam::tools
