#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/interpolation.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

/// "nearest", "linear", "inverse"
std::vector<std::string> interpolation_names();
/// Throws Error that lists them for any other.
Interpolation interpolation_from_name(std::string_view name);
bool is_interpolation(std::string_view name);

/// What fills the rows between the measured ones: a trained network or interpolation. Threads: as
/// SuperResolver.
class Upsampler {
 public:
  /// For the sensor that the network was made for.
  explicit Upsampler(SuperResolver network);
  /// sensor: of the result, all rows, as if all were measured; where the beams of one unit are
  /// known better than the network's description has them.
  Upsampler(SuperResolver network, SensorModel sensor);
  Upsampler(Interpolation interpolation, SensorModel sensor, RowSelection measured_rows);

  /// Of the result; names the measured rows.
  const SensorModel& sensor() const { return sensor_; }
  RowSelection measured_rows() const { return *sensor_.measured_rows; }
  /// Of what is upsampled: the measured rows alone.
  SensorModel measured_sensor() const { return select_rows(sensor_, measured_rows()); }
  /// "du-or", "simple-du", "linear", ...
  std::string name() const;
  /// Nothing for interpolation.
  const SuperResolver* network() const { return std::get_if<SuperResolver>(&method_); }

  /// measured: the measured rows alone, metres. Returns all rows; of interpolation without a
  /// confidence. Throws Error.
  UpsampledImage run(const RangeImage& measured) { return run(measured, {}); }
  /// The same with what earlier scans tell of it, where the network has a memory.
  UpsampledImage run(const RangeImage& measured, const RecalledImage& recalled);
  bool has_scan_memory() const {
    return network() != nullptr && nn::has_scan_memory(network()->description());
  }

 private:
  std::variant<SuperResolver, Interpolation> method_;
  SensorModel sensor_;
};

}  // namespace hqslam::nn
