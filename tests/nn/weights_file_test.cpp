#include "hqslam/nn/weights_file.h"

#include "golden_folder.h"
#include "hqslam/core/npz.h"
#include "hqslam/nn/network_json.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

std::string golden_file(const std::string& name) { return golden_folder() + "/" + name + ".npz"; }

/// A weights file after `change` was made to its arrays.
void refuses_arrays(const auto& change, const auto&... parts) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("weights.npz");
  write_weights(path, small_weights(small_du_or(), 7));
  NpzArrays arrays = read_npz(path);
  change(arrays);
  write_npz(path, arrays);
  CHECK(refused_with([&] { check_self_test(read_weights(path), path); }, parts...));
}
/// With an array instead of one, or without it.
void refuses_array(const char* name, const std::optional<NpzArray>& instead, const auto&... parts) {
  refuses_arrays(
      [&](NpzArrays& arrays) {
        arrays.erase(name);
        if (instead) arrays[name] = *instead;
      },
      parts...);
}
/// After `from` became `to` in the description.
void refuses_description(const std::string& from, const std::string& to, const auto&... parts) {
  CAPTURE(to);
  refuses_arrays(
      [&](NpzArrays& arrays) {
        const std::string text = text_value(arrays["description"], "description");
        arrays["description"] = npz_text(replaced_in(text, from, to));
      },
      parts...);
}

}  // namespace

TEST_CASE("weights of every network come back as they were written") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("weights.npz");
  for (const NetworkDescription& description :
       {NetworkDescription(small_du_or()), NetworkDescription(small_simple_du()), small_du_mix()}) {
    const Weights written = small_weights(description, 7);
    write_weights(path, written);
    const Weights read = read_weights(path);
    CHECK(read.parameters == written.parameters);
    CHECK(network_json(read.description) == network_json(description));
    CHECK(read.description.sensor.name == description.sensor.name);
    CHECK(read.self_test.expected.range_m == written.self_test.expected.range_m);
    CHECK(nlohmann::json::parse(read.training) == nlohmann::json::parse(written.training));
    CHECK_NOTHROW(check_self_test(read, path));
  }
}

TEST_CASE("a changed weight is found by the self-test, and one of another shape is refused") {
  refuses_arrays(
      [](NpzArrays& arrays) {
        std::vector<float> bias = float_values(arrays["layers.2.head.bias"], "bias");
        bias[70] += 0.5F;
        arrays["layers.2.head.bias"] = npz_array(bias, {static_cast<std::int64_t>(bias.size())});
      },
      "self-test", "differ");
  Weights weights = small_weights(small_du_or(), 7);
  weights.self_test.expected = RangeImage(15, 64);
  CHECK(refused_with([&] { check_self_test(weights, "a.npz"); }, "a.npz", "1024 pixels",
                     "found 960"));
}

TEST_CASE("missing, unknown, misshapen and non-finite arrays are refused by name") {
  using Floats = std::vector<float>;
  refuses_array("layers.1.bottleneck.bias", {}, "layers.1.bottleneck.bias", "expected",
                "found none");
  refuses_array("extra", npz_array(Floats{1.0F}, {1}), "unknown array 'extra'");
  refuses_array("log_penalty", npz_array(Floats{1.0F, 2.0F}, {2}), "log_penalty",
                "expected shape 3", "found 2");
  refuses_array("log_penalty", npz_array(Floats{1.0F, NAN, 2.0F}, {3}), "log_penalty", "finite");
  refuses_array("self_test.measured", {}, "self_test.measured", "found none");
  refuses_array("description", {}, "description", "hqslam-lab train");
}

TEST_CASE("a description that does not fit is refused with field, expected and found") {
  refuses_description("\"du-or\"", "\"du-xor\"", "kind", "one of du-or, simple-du", "du-xor");
  refuses_description("\"layers\": 3", "\"layers\": 300", "layers is 300", "1 to 20");
  refuses_description("\"layers\": 3", "\"layerz\": 3", "unknown field", "layerz");
  refuses_description("\"layers\": 3", "\"layers\": 4", "layers.3.encoder.0.weight", "found none");
  refuses_description("\"memory\": 3", "\"memory\": 1e9", "memory");
  refuses_description("\"tile_rows\": 4", "\"tile_rows\": 3", "an image of 16 x 64",
                      "multiples of 6 x 8", "smaller tile_rows");
  refuses_description("\"format\": \"hqslam-weights-1\"", "\"format\": 2", "format");
  refuses_description("\"stride\": 4", "\"stride\": 0", "no selection");
}

TEST_CASE("weights that no reader would take are not written") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("weights.npz");
  for (const int missing : {1, -1}) {
    Weights weights = small_weights(small_du_or(), 7);
    weights.parameters.resize(weights.parameters.size() - missing);
    CHECK(refused_with([&] { write_weights(path, weights); }, path, "expected", "parameters",
                       "du-or"));
  }
  Weights weights = small_weights(small_du_or(), 7);
  weights.training = "{\"seed\": ";
  CHECK(refused_with([&] { write_weights(path, weights); }, "weights.npz: training",
                     "expected JSON"));
  CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("arrays that PyTorch exported give the ranges that PyTorch gave, within 1e-4 m") {
  const std::vector<std::pair<std::string, NetworkDescription>> exported = {
      {"du_or", small_du_or()}, {"simple_du", small_simple_du()}, {"du_mix", small_du_mix()}};
  for (const auto& [network, description] : exported) {
    const std::string& name = network;
    CAPTURE(name);
    const ForeignArrays foreign = read_foreign_arrays(golden_file("exported_" + name), description);
    REQUIRE(foreign.self_test.has_value());
    const SelfTest ours =
        make_self_test(*made(description, foreign.parameters), foreign.self_test->measured);
    REQUIRE(ours.expected.range_m.size() == foreign.self_test->expected.range_m.size());
    float largest_gap_m = 0.0F;
    for (std::size_t i = 0; i < ours.expected.range_m.size(); ++i) {
      largest_gap_m = std::max(largest_gap_m, std::abs(ours.expected.range_m[i] -
                                                       foreign.self_test->expected.range_m[i]));
    }
    CHECK(largest_gap_m < 1e-4F);
  }
}

TEST_CASE("arrays of double precision are taken, missing and unknown ones named") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("arrays.npz");
  NpzArrays arrays = read_npz(golden_file("exported_simple_du"));
  arrays.erase("self_test.measured");
  arrays.erase("self_test.expected");
  arrays["alpha"] = npz_array(std::vector<double>{1.5}, {1});
  write_npz(path, arrays);
  const ForeignArrays foreign = read_foreign_arrays(path, small_simple_du());
  CHECK_FALSE(foreign.self_test.has_value());
  CHECK(foreign.parameters.back() == 1.5F);

  arrays["batch_norm.weight"] = npz_array(std::vector<float>{1.0F}, {1});
  write_npz(path, arrays);
  const auto read = [&] { read_foreign_arrays(path, small_simple_du()); };
  CHECK(refused_with(read, path, "unknown array 'batch_norm.weight'"));
  arrays.erase("batch_norm.weight");
  arrays.erase("alpha");
  write_npz(path, arrays);
  CHECK(refused_with(read, path, "expected an array 'alpha' of 1, found none"));
}

}  // namespace hqslam::nn
