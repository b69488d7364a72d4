#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/npz.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/training/checkpoint.h"
#include "hqslam/nn/training/training_configuration.h"
#include "hqslam/nn/weights_file.h"
#include "input_file.h"
#include "readers.h"
#include "weights_arrays.h"

namespace hqslam::fuzz {

namespace {

/// A network of a few hundred parameters.
const nn::NetworkDescription& small_network() {
  static const nn::NetworkDescription network = [] {
    SensorModel sensor = sensor_preset("vlp-16");
    sensor.columns = 32;
    return nn::network_from_json(
        R"({"kind": "du-or", "layers": 1, "denoiser": {"channels": [2, 2], "memory": 1},
            "filter": {"min_pixels": 0}, "measured_rows": {"offset": 3, "stride": 4}, "sensor": )" +
            sensor_json(sensor) + "}",
        "small network");
  }();
  return network;
}

constexpr std::size_t kHead = 3;

/// An array in place of a good one. The checksums of a zip archive would keep random changes of its
/// bytes out of the readers behind it, so the input is the array, and no archive is there: the
/// first byte says which, the second of what type, the third how the rest is cut into rows.
NpzArray replaced(NpzArray array, Bytes input) {
  constexpr std::pair<const char*, std::size_t> kTypes[] = {
      {"", 1}, {"<f4", 4}, {"<f8", 8}, {"<i8", 8}, {"|u1", 1}};
  const auto& [dtype, bytes] = kTypes[input[1] % std::size(kTypes)];
  const Bytes rest = input.subspan(kHead);
  if (*dtype == '\0') {  // the values alone
    std::memcpy(array.bytes.data(), rest.data(), std::min(rest.size(), array.bytes.size()));
    return array;
  }
  const std::size_t columns = 1 + input[2] % 16U;
  const std::size_t rows = rest.size() / bytes / columns;
  array.dtype = dtype;
  array.shape = {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns)};
  if (columns == 1) array.shape.pop_back();
  array.bytes.resize(rows * columns * bytes);
  std::memcpy(array.bytes.data(), rest.data(), array.bytes.size());
  return array;
}

/// The arrays with one replaced.
NpzArrays with_one_replaced(NpzArrays arrays, Bytes input) {
  if (input.size() < kHead) return arrays;
  const std::size_t which = input[0] % arrays.size();
  NpzArray& array = std::next(arrays.begin(), static_cast<std::ptrdiff_t>(which))->second;
  array = replaced(std::move(array), input);
  return arrays;
}

NpzArrays good_weights() {
  nn::Weights good;
  good.description = small_network();
  good.parameters = nn::initial_parameters(good.description, 1);
  good.training = "{}";
  good.self_test = nn::make_self_test(good.description, good.parameters, RangeImage(4, 32));
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

}  // namespace

void weights(Bytes input) {
  static const NpzArrays good = good_weights();
  nn::weights_of(with_one_replaced(good, input), "input.npz");
}

void checkpoint(Bytes input) {
  static const NpzArrays good = good_checkpoint();
  static const auto parameters =
      static_cast<std::size_t>(nn::elements(nn::parameter_shapes(small_network())));
  nn::checkpoint_of(with_one_replaced(good, input), "input.npz", "{}", parameters, {});
}

void recipe_json(Bytes input) {
  nn::training_configuration({reinterpret_cast<const char*>(input.data()), input.size()}, "recipe");
}

}  // namespace hqslam::fuzz
