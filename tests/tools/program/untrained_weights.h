#pragma once

#include <fmt/format.h>

#include <string>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/weights_file.h"
#include "made_images.h"

namespace hqslam::test {

/// A small untrained network, for scans of `sensor` of which every fourth row is
/// measured: its ranges are poor, but it runs at once. feature: of du-mix, "scan_memory" or
/// "any_beams".
inline nn::Weights untrained_weights(const SensorModel& sensor, const std::string& kind,
                                     const std::string& feature = "") {
  const std::string size = kind == "du-mix"
                               ? fmt::format(R"("denoiser": {{{} "layers":
              [{{"channels": 8, "lower_channels": 8, "residual_blocks": 1}}]}})",
                                             feature.empty() ? "" : '"' + feature + "\": true,")
                               : R"("layers": 2, "denoiser": {"channels": [8, 8], "memory": 1})";
  nn::Weights weights;
  weights.description = nn::network_from_json(
      fmt::format(R"({{"kind": "{}", "sensor": {}, "measured_rows": {}, {}}})", kind,
                  sensor_json(sensor), sensor.rows() / 4, size),
      "untrained");
  weights.parameters = initial_parameters(weights.description, 1);
  weights.training = "{}";
  RangeImage measured(sensor.rows() / 4, sensor.columns);
  for (int row = 0; row < measured.rows; ++row) {
    for (int column = 0; column < measured.columns; ++column) {
      measured.at(row, column) =
          4.0F + static_cast<float>(row) + 0.01F * static_cast<float>(column);
    }
  }
  const auto network =
      nn::make_network(weights.description, sensor.columns, nn::chosen_instruction_set(), 1);
  network->set_parameters(weights.parameters);
  weights.self_test = make_self_test(*network, measured);
  return weights;
}

inline void write_untrained_weights(const std::string& path, const SensorModel& sensor,
                                    const std::string& kind = "du-or") {
  write_weights(path, untrained_weights(sensor, kind));
}

}  // namespace hqslam::test
