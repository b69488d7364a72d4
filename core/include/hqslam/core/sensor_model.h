#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hqslam {

/// Which rows of a sensor are kept: offset, offset + stride, offset + 2 stride, ...
struct RowSelection {
  int offset = 0;
  int stride = 1;

  bool contains(int row) const { return row >= offset && (row - offset) % stride == 0; }
  bool operator==(const RowSelection&) const = default;
};

/// The rows that make a sensor with `wanted` rows of one with `rows`: the lowest of each group, so
/// 16 of 64 are 3, 7, ..., 63. Throws Error unless `wanted` divides `rows`.
RowSelection selection_for(int rows, int wanted);

/// The numbers of the selected rows of an image or a sensor with `rows` rows; at least one. Throws
/// Error unless the first one is there and the stride is positive.
std::vector<int> selected_rows(int rows, RowSelection selection);

/// A spinning LiDAR as the geometry of its range image.
///
/// Row 0 is the highest beam. The centre of pixel (row, column) looks along
///   azimuth = pi - (column + 1/2) * 2 pi / columns + residual_azimuth_rad[row]
///   elevation = beam_elevation_rad[row]
/// in the sensor frame (x forward, y left, z up), so column 0 looks backwards and azimuth falls
/// with the column; columns wrap around.
///
/// A real beam has an azimuth offset of up to a few degrees. Its whole columns are taken out when
/// the image is made (`column_shift`), so that neighbours in a column look the same way; what is
/// left, at most half a column, is `residual_azimuth_rad`. Pixel (row, column) is thus measured
/// when the sensor's head stands at column `firing_column(row, column)`.
struct SensorModel {
  std::string name;
  int columns = 0;
  double scan_period_s = 0.1;
  double min_range_m = 0.5;
  double max_range_m = 120.0;
  std::vector<double> beam_elevation_rad;       ///< one per row, strictly falling
  std::vector<double> beam_azimuth_offset_rad;  ///< one per row, counter-clockwise positive
  /// What a calibration found (slam/beam_calibration.h), one per row: to be added to a beam's
  /// elevation and to what it measures. Empty: nothing. The rest of the model is its maker's table.
  std::vector<double> elevation_correction_rad;
  std::vector<double> range_correction_m;
  /// The rows that a beam measures; those between them are computed from them. Nothing: all are
  /// measured.
  std::optional<RowSelection> measured_rows;
  /// Whether its range images were corrected for the sensor's motion before they were recorded.
  bool motion_corrected = false;

  int rows() const { return static_cast<int>(beam_elevation_rad.size()); }
  double column_step_rad() const;
  /// Whole columns by which the beam of this row leads (positive: looks at a smaller column).
  int column_shift(int row) const;
  double residual_azimuth_rad(int row) const;
  double azimuth_rad(int row, int column) const;
  /// The column at which the head stands when pixel (row, column) is measured, 0..columns-1.
  int firing_column(int row, int column) const;
  /// The column whose pixel contains this direction, 0..columns-1.
  int column_of(int row, double azimuth_rad) const;
  /// The column of this azimuth in a row without residual azimuth.
  int column_of_azimuth(double azimuth_rad) const;

  bool operator==(const SensorModel&) const = default;
};

/// Throws Error with field, value and constraint when the model breaks its invariants.
void validate(const SensorModel& sensor);

/// Two units of one type differ by at most this much from their data sheet.
inline constexpr double kBeamTolerance_deg = 0.25;
/// Whether two sensors have the same number of rows and beams within kBeamTolerance_deg.
bool have_same_beams(const SensorModel& a, const SensorModel& b);

/// The sensor that has only the selected rows. Its name has the selection ("os1-64/3:4").
SensorModel select_rows(const SensorModel& sensor, RowSelection rows);

/// The sensor with `factor` times as many rows, of which its own are the measured ones: the last of
/// every group, the others evenly between it and the beam above. Throws Error unless it has two
/// beams and factor is 2 or more.
SensorModel with_rows_between(const SensorModel& sensor, int factor);

/// os1-64, os1-16, hdl-64e, hdl-32e, vlp-16, vlp-32c, vls-128. Throws Error for any other.
SensorModel sensor_preset(std::string_view name);
std::vector<std::string> sensor_preset_names();

/// A sensor model as JSON (angles in degrees). `read` accepts this form and Ouster's metadata
/// files (beam_altitude_angles, beam_azimuth_angles, lidar_mode or data_format). Throws Error.
SensorModel read_sensor_json(const std::string& path);
void write_sensor_json(const SensorModel& sensor, const std::string& path);
/// read_sensor_json of a text; `source` stands for the file in messages.
SensorModel sensor_from_json(const std::string& text, const std::string& source);
std::string sensor_json(const SensorModel& sensor);

/// A preset's name or the path of a .json file. Throws Error.
SensorModel load_sensor(const std::string& preset_or_path);

}  // namespace hqslam
