#pragma once

#include <string>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/weights_file.h"

namespace hqslam::test {

/// A weights file of a network that nobody has trained, for scans of `sensor` of which every fourth
/// row is measured: its ranges are poor, but it runs.
inline void write_untrained_weights(const std::string& path, const SensorModel& sensor,
                                    nn::NetworkKind kind = nn::NetworkKind::kDuOr) {
  nn::Weights weights;
  weights.description.kind = kind;
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
  write_weights(path, weights);
}

}  // namespace hqslam::test
