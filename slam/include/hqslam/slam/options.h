#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>

namespace hqslam::slam {

/// Angles in radians, lengths in metres. option_table() has the meaning and bounds of each, and its
/// value in LeGO-LOAM where that is not the default.

/// How the sensor is mounted: turned from level by roll about x, then pitch about y. Positive roll
/// raises the left side, positive pitch lowers the front; a roll of pi is upside down.
struct MountingOptions {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  bool estimated = false;
};
/// The rotation from the sensor's frame to the level one, z up.
Eigen::Matrix3d R_level_sensor(const MountingOptions& mounted);

struct MappingOptions {
  int max_iterations = 40;  ///< chosen on a real handheld OS0
  int min_correspondences = 50;
  double planar_leaf_m = 0.4;
  double located_planar_leaf_m = 0.8;  ///< chosen in simulation alone
  double trusted_residual_m = 0.05;    ///< chosen in simulation alone
  double max_plane_residual_m = 0.2;
  double max_ground_residual_m = 0.05;  ///< chosen in simulation alone
  double recent_path_m = 200.0;         ///< chosen in simulation alone
};

struct LoopClosingOptions {
  bool enabled = true;
};

struct SlamOptions {
  int threads = 0;  ///< 0: the default of OpenMP
  MountingOptions mounting;
  MappingOptions mapping;
  LoopClosingOptions loop_closing;
};

/// Throws Error with field, value and constraint.
void validate(const SlamOptions& options);

/// A numeric option of SlamOptions.
struct NamedOption {
  std::string_view name;  ///< "mapping.max_iterations"
  std::string_view meaning;
  std::string_view expected;  ///< "a positive number"
  bool is_whole = false;
  bool (*holds)(double value);
  double (*get)(const SlamOptions& options);
  void (*set)(SlamOptions& options, double value);
};
/// All options but threads and loop_closing.enabled, in the order of the stages.
std::span<const NamedOption> option_table();

/// Sets one option. Throws Error if there is none of that name, or its value is out of bounds or
/// not whole where it must be; combinations are checked by validate().
void set_option(SlamOptions& options, std::string_view name, double value);

}  // namespace hqslam::slam
