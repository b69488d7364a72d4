#pragma once

#include <string>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/weights_file.h"

namespace hqslam::test {

/// A network that nobody has trained, for scans of `sensor` of which every fourth row is measured:
/// its ranges are poor, but it runs.
inline nn::Weights untrained_weights(const SensorModel& sensor, nn::NetworkKind kind) {
  nn::Weights weights;
  weights.description.kind = kind;
  if (kind == nn::NetworkKind::kDuMix) weights.description.layers = 1;
  weights.description.sensor = sensor;
  weights.description.measured_rows = selection_for(sensor.rows(), sensor.rows() / 4);
  weights.parameters = initial_parameters(weights.description, 1);
  weights.training = "{}";
  RangeImage measured(sensor.rows() / 4, sensor.columns);
  for (int row = 0; row < measured.rows; ++row) {
    for (int column = 0; column < measured.columns; ++column) {
      measured.at(row, column) =
          4.0F + static_cast<float>(row) + 0.01F * static_cast<float>(column);
    }
  }
  weights.self_test = make_self_test(weights.description, weights.parameters, measured);
  return weights;
}

inline void write_untrained_weights(const std::string& path, const SensorModel& sensor,
                                    nn::NetworkKind kind = nn::NetworkKind::kDuOr) {
  write_weights(path, untrained_weights(sensor, kind));
}

}  // namespace hqslam::test
