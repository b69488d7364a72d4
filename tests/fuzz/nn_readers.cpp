#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/npz.h"
#include "hqslam/nn/hqs/network_json.h"
#include "hqslam/nn/hqs/weights_file.h"
#include "hqslam/nn/training/checkpoint.h"
#include "hqslam/nn/training/training_configuration.h"
#include "input_file.h"
#include "npy_header_bytes.h"
#include "readers.h"
#include "zip_by_hand.h"

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

/// An array in place of a good one. The checksums of a zip archive keep random changes of its bytes
/// out of the readers behind it, so the input is the array: the first byte says which, the second
/// of what type, the third how the rest is cut into rows.
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

std::string npy_file(const NpzArray& array) {
  return npy_header_bytes(array.dtype, array.shape, 0) +
         std::string(reinterpret_cast<const char*>(array.bytes.data()), array.bytes.size());
}

/// Arrays in a zip archive that is put together without packing: a library takes ten times as long
/// to write as the readers take to read.
class Archive {
 public:
  explicit Archive(NpzArrays good) : good_(std::move(good)) {
    for (const auto& [name, array] : good_) {
      members_.push_back(test::stored(npy_file(array), name + ".npy"));
    }
  }

  /// The file with one array replaced.
  std::string with_one_replaced(Bytes input) const {
    std::vector<test::HandMember> members = members_;
    if (input.size() >= kHead) {
      const std::size_t which = input[0] % members.size();
      const auto& good = std::next(good_.begin(), static_cast<std::ptrdiff_t>(which))->second;
      members[which] = test::stored(npy_file(replaced(good, input)), members[which].name);
    }
    const std::string file = test::zip_of(members);
    return as_file({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, ".npz");
  }

 private:
  NpzArrays good_;
  std::vector<test::HandMember> members_;
};

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
  static const Archive good(good_weights());
  nn::read_weights(good.with_one_replaced(input));
}

void checkpoint(Bytes input) {
  static const Archive good(good_checkpoint());
  nn::read_checkpoint(good.with_one_replaced(input), "{}", small_network(), {});
}

void recipe_json(Bytes input) {
  nn::training_configuration({reinterpret_cast<const char*>(input.data()), input.size()}, "recipe");
}

}  // namespace hqslam::fuzz
