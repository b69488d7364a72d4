#include "hqslam/nn/network.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/training/checkpoint.h"
#include "hqslam/nn/training/training_configuration.h"
#include "hqslam/nn/weights_file.h"
#include "input_file.h"
#include "made_images.h"
#include "replaced_array.h"

namespace hqslam::fuzz {
namespace {

/// A network of a few hundred parameters.
const nn::NetworkDescription& small_network() {
  static const nn::NetworkDescription network = nn::network_from_json(
      R"({"kind": "du-or", "layers": 1, "denoiser": {"channels": [2, 2], "memory": 1},
          "filter": {"min_pixels": 0}, "measured_rows": {"offset": 3, "stride": 4}, "sensor": )" +
          sensor_json(test::preset_with("vlp-16", 32)) + "}",
      "small network");
  return network;
}

NpzArrays good_weights() {
  nn::Weights good;
  good.description = small_network();
  good.parameters = nn::initial_parameters(good.description, 1);
  good.training = "{}";
  const auto network = nn::make_network(good.description, 32, nn::InstructionSet::kPortable, 1);
  network->set_parameters(good.parameters);
  good.self_test = nn::make_self_test(*network, RangeImage(4, 32));
  const std::string path = as_file({}, ".npz");
  nn::write_weights(path, good);
  return read_npz(path);
}

NpzArrays good_checkpoint() {
  const std::vector<float> parameters = nn::initial_parameters(small_network(), 1);
  nn::Checkpoint good{"{}",
                      {parameters, nn::AdamW(nn::AdamWOptions{}, parameters.size()), parameters},
                      {nn::CurvePoint{}}};
  const std::string path = as_file({}, ".npz");
  nn::write_checkpoint(path, good);
  return read_npz(path);
}

std::string as_npz(const NpzArrays& arrays) {
  std::string path = as_file({}, ".npz");
  write_npz(path, arrays);
  return path;
}

}  // namespace

void weights(Bytes input) {
  static const NpzArrays good = good_weights();
  nn::read_weights(as_npz(with_one_replaced(good, input)));
}

void checkpoint(Bytes input) {
  static const NpzArrays good = good_checkpoint();
  nn::read_checkpoint(as_npz(with_one_replaced(good, input)), "{}", small_network(), {});
}

void recipe_json(Bytes input) {
  nn::training_configuration({reinterpret_cast<const char*>(input.data()), input.size()}, "recipe");
}

}  // namespace hqslam::fuzz
