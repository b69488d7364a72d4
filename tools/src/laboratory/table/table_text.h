#pragma once

#include <string>
#include <vector>

#include "laboratory/table/table_figures.h"
#include "report/text_table.h"

namespace hqslam::tools {

/// A number with three digits that count: "0.042", "3.78", "31.7", "6717".
std::string three_digits(double value);

/// The paper's table: RMSE against LiDAR-64 on all drives, frames per second, parameters.
TextTable paper_table(const std::vector<DriveFigures>& drives, std::size_t loop_closing);
/// Errors and times of the trajectories.
TextTable trajectory_table(const DriveFigures& drive, std::size_t loop_closing);
/// Image errors, speed and size of the upsampling.
TextTable upsampling_table(const DriveFigures& drive);

/// "town: 4000 scans of an os1-64, 2963 m; ..."
std::string drive_text(const DriveFigures& drive);
/// What the columns mean and how it was measured.
std::vector<std::string> drives_notes(const std::vector<DriveFigures>& drives);

}  // namespace hqslam::tools
