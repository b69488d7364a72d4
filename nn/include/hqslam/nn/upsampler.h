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
/// Throws Error that lists the names for any other.
Interpolation interpolation_from_name(std::string_view name);
bool is_interpolation(std::string_view name);

/// What fills the rows between the measured ones: a trained network or interpolation. Threads: as
/// SuperResolver.
class Upsampler {
 public:
  /// For the sensor that the network was made for.
  explicit Upsampler(SuperResolver network);
  /// sensor: of the result, all rows, as if all were measured; for a unit whose beams are known
  /// better than from the network's description.
  Upsampler(SuperResolver network, SensorModel sensor);
  Upsampler(Interpolation interpolation, SensorModel sensor, RowSelection measured_rows);

  /// The sensor of the result, with its measured rows.
  const SensorModel& sensor() const { return sensor_; }
  RowSelection measured_rows() const { return *sensor_.measured_rows; }
  /// The sensor of what is upsampled: the measured rows alone.
  SensorModel measured_sensor() const { return select_rows(sensor_, measured_rows()); }
  /// "du-or", "simple-du", "linear", ...
  std::string name() const;
  /// Null for an interpolation.
  const SuperResolver* network() const { return std::get_if<SuperResolver>(&method_); }

  /// measured: the measured rows alone, metres. Returns all rows; interpolation gives no
  /// confidence. Throws Error for another shape.
  UpsampledImage run(const RangeImage& measured) { return run(measured, {}); }
  /// Upsamples with what is recalled of earlier scans too, if the network has a memory.
  UpsampledImage run(const RangeImage& measured, const RecalledImage& recalled);
  bool has_scan_memory() const {
    return network() != nullptr && nn::has_scan_memory(network()->description());
  }

 private:
  std::variant<SuperResolver, Interpolation> method_;
  SensorModel sensor_;
};

}  // namespace hqslam::nn
