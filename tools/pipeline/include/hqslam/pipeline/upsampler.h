#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/upsampler.h"

namespace hqslam::pipeline {

/// How the rows between the measured ones are filled.
struct UpsamplingOptions {
  /// A weights file, the name of weights that come with hqslam ("du-mix"), or an interpolation
  /// ("nearest", "linear", "inverse"); empty: scans stay as they are measured.
  std::string method = {};
  /// How many rows of the recording are used as measured, evenly spread. 0: the network's measured
  /// rows, all rows of weights for any sensor; every fourth row for an interpolation; all rows
  /// where nothing is upsampled.
  int rows = 0;
  /// With weights for any sensor and all rows of the recording: the widest gap between two rows of
  /// the result, in radians. 0: 64 rows in all, or twice those of the recording.
  double spacing_rad = 0.0;
  /// The sensor of the result, for the interpolation of scans that have its measured rows alone.
  std::optional<SensorModel> all_rows = {};
  nn::SuperResolverOptions network = {};
  /// The recording's sensor with corrections of its beams, to be used in place of its own
  /// (beam_check.h); nothing: the sensor's own.
  std::optional<SensorModel> corrected = {};
};

/// A loaded network or an interpolation; std::monostate: scans stay as they are measured.
using UpsamplingMethod = std::variant<std::monostate, nn::SuperResolver, nn::Interpolation>;

/// recorded: the sensor, by which the weights of a name are chosen; nothing: not known yet. Throws
/// Error.
UpsamplingMethod load_method(const UpsamplingOptions& options,
                             const std::optional<SensorModel>& recorded = {});

/// The sensor that a method was made for, with all rows, of which it names the measured ones;
/// nothing for methods that fit any sensor.
std::optional<SensorModel> sensor_of(const UpsamplingMethod& method);

/// Recorded scans in, scans with all rows out:
///
///   recorded -> measured: calibrated, the measured rows alone -> upsampled: all rows
///
/// A recording has either the measured rows alone, or all rows, of which the measured ones are
/// selected. Threads: one object serves one caller at a time.
class Upsampler {
 public:
  /// recorded: the sensor of the scans. source: names them in messages. Throws Error where the
  /// method was made for another sensor, with what it expects.
  Upsampler(const SensorModel& recorded, const UpsamplingOptions& options,
            const std::string& source = "the recording");
  Upsampler(const SensorModel& recorded, UpsamplingMethod method, const UpsamplingOptions& options,
            const std::string& source = "the recording");
  /// For the sensor that the weights were made for, scans of its measured rows alone.
  explicit Upsampler(const UpsamplingOptions& options);

  /// The sensor of recorded scans, in the method's columns: packets and points are best put into
  /// these at once. Scans in more columns are projected anew.
  const SensorModel& recorded() const { return recorded_; }
  /// The sensor of what measured() returns.
  const SensorModel& measured_sensor() const { return measured_sensor_; }
  /// The sensor of what upsampled() returns.
  const SensorModel& sensor() const { return method_ ? method_->sensor() : measured_sensor_; }
  /// The rows of the recording that are measured; nothing: all of its rows.
  const std::optional<RowSelection>& selected_rows() const { return rows_; }
  /// nullptr where scans stay as they are measured.
  nn::Upsampler* method() { return method_ ? &*method_ : nullptr; }
  const nn::Upsampler* method() const { return method_ ? &*method_ : nullptr; }
  /// Whether it gives each computed pixel a confidence.
  bool has_confidence() const {
    return method_ && method_->network() != nullptr &&
           nn::has_confidence(method_->network()->description());
  }
  bool has_scan_memory() const { return method_ && method_->has_scan_memory(); }

  /// The measured rows of a recorded scan, with the corrections of each beam that a calibration
  /// found. Throws Error for a scan of another shape.
  OrganizedCloud measured(const OrganizedCloud& recorded) const;
  /// All rows. recalled: what other scans measured, for networks with a memory.
  OrganizedCloud upsampled(const OrganizedCloud& measured, const nn::RecalledImage& recalled = {});

 private:
  void fit_network(nn::SuperResolver network, const UpsamplingOptions& options,
                   const std::string& source);
  void fit_interpolation(nn::Interpolation interpolation, const UpsamplingOptions& options,
                         const std::string& source);

  SensorModel recorded_;
  int columns_ = 0;  ///< of recorded scans, before they are projected anew
  SensorModel measured_sensor_;
  std::optional<RowSelection> rows_;
  std::optional<nn::Upsampler> method_;
};

/// A sensor fits a network made for more columns if it has at least this share of them: sensors do
/// not keep their rate to the percent.
inline constexpr double kFewestColumnsShare = 0.9;

/// The weights that come with hqslam and that SuperResolver::load reads: names such as "du-mix" and
/// "du-mix-memory".
std::vector<std::string> installed_weights_names();
/// The weights files of such a name, one for each sensor.
std::vector<std::string> installed_weights_files(const std::string& name);
/// Whether a method is such a name, and not a file.
bool is_weights_name(const std::string& method);
/// The weights file that a method is or names. recorded: as for load_method. rows:
/// UpsamplingOptions::rows. Of a name with weights for any sensor, those for one sensor are chosen
/// where their measured rows alone were recorded, or asked for. Throws Error.
std::string weights_file(const std::string& method, const std::optional<SensorModel>& recorded,
                         int rows);
/// The path of a weights file that comes with hqslam, such as "du-or_os1_16to64.npz": beside the
/// installed program (../share/hqslam/weights), where hqslam was installed, or in the source tree
/// it was built from. Nothing if it is in none of them.
std::optional<std::string> installed_weights(const std::string& file);

}  // namespace hqslam::pipeline
