#pragma once

#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/pipeline/pipeline.h"

namespace hqslam::tools {

/// Rows of a recording, and the number of them that are measured.
inline constexpr int kTableAllRows = 64;
inline constexpr int kTableMeasuredRows = 16;

/// The inputs of SLAM beside the points: their sensor, which SLAM, and its options.
struct SlamSetup {
  SensorModel sensor;
  pipeline::PipelineOptions options;  ///< without upsampling
};

/// METHOD+as-published is METHOD in front of LeGO-LOAM as published.
inline constexpr const char* kAsPublished = "+as-published";

/// A row of the table: what makes SLAM's input from a recording, and which SLAM.
struct TableMethod {
  std::string name;               ///< for --methods and in file names
  std::string title;              ///< in the table
  int rows = kTableMeasuredRows;  ///< of the recording that are used
  /// The source of the rows between them: "" none, an interpolation, the name of weights that come
  /// with the program, or a weights file.
  std::string source = {};
  bool filtered = true;  ///< whether a network's own filter at the end runs
  pipeline::SlamKind slam = pipeline::SlamKind::kHqslam;
};

/// The names of LiDAR-16 and of LiDAR-64, between which methods close a gap.
inline constexpr const char* kFewRows = "rows-16";
inline constexpr const char* kAllRows = "rows-64";

/// The default rows of the table, in order.
const std::vector<TableMethod>& table_methods();
/// "rows-16, nearest, ..."
std::string table_method_names();
/// One of them or a weights file (.npz), itself or with kAsPublished. option: names it in messages.
/// Throws Error.
TableMethod method_named(const std::string& text, const char* option);

/// How a method fills the rows of a recording.
pipeline::UpsamplingOptions upsampling_of(const TableMethod& method);
/// The setup of SLAM for a method, without loop closing; `sensor`: of its clouds.
SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor);

}  // namespace hqslam::tools
