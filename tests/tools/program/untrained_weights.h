#pragma once

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
  const RangeImage measured =
      made_image(sensor.rows() / 4, sensor.columns,
                 [](int row, int column) { return 4.0 + row + 0.01 * column; });
  const auto network =
      nn::make_network(weights.description, sensor.columns, nn::chosen_instruction_set(), 1);
  network->set_parameters(weights.parameters);
  weights.self_test = make_self_test(*network, measured);
  return weights;
}

/// The file of such a network for an OS1-64, made once per test program.
inline const std::string& untrained_file(const std::string& kind = "du-or",
                                         const std::string& feature = "") {
  static const TemporaryDirectory folder;
  static std::map<std::string, std::string> files;
  std::string& file = files[kind + feature];
  if (file.empty()) {
    file = folder.file(kind + feature + ".npz");
    write_weights(file, untrained_weights(sensor_preset("os1-64"), kind, feature));
  }
  return file;
}

}  // namespace hqslam::test
