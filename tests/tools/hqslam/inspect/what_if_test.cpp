#include "inspect/what_if.h"

#include <nlohmann/json.hpp>

#include "tools/program/untrained_weights.h"

namespace hqslam::tools {
namespace {

nn::Weights untrained(const std::string& kind) {
  return untrained_weights(preset_with("os1-64", 64), kind);
}

/// DU-OR of three layers for a small sensor; each parameter has a value of its own.
nn::Weights three_layers() {
  nlohmann::ordered_json network =
      nlohmann::ordered_json::parse(nn::network_json(untrained("du-or").description));
  network["layers"] = 3;
  nn::Weights weights;
  weights.description = nn::network_from_json(network.dump(), "test");
  weights.parameters.resize(nn::elements(nn::parameter_shapes(weights.description)));
  for (std::size_t i = 0; i < weights.parameters.size(); ++i) {
    weights.parameters[i] = static_cast<float>(i);
  }
  return weights;
}

nlohmann::json network_of(const nn::Weights& weights) {
  return nlohmann::json::parse(nn::network_json(weights.description));
}

}  // namespace

TEST_CASE("b=0.5 fixes the penalty, and all other parameters stay as they were trained") {
  const nn::Weights trained = three_layers();
  const nn::Weights changed = what_if(trained, "b=0.5");
  CHECK(network_of(changed)["penalty"] == 0.5);
  // The penalties are the last three parameters.
  REQUIRE(changed.parameters.size() + 3 == trained.parameters.size());
  CHECK(
      std::equal(changed.parameters.begin(), changed.parameters.end(), trained.parameters.begin()));
}

TEST_CASE("layers=2 keeps the first two layers with their penalties") {
  const nn::Weights trained = three_layers();
  const nn::Weights changed = what_if(trained, "layers=2");
  CHECK(network_of(changed)["layers"] == 2);
  const std::size_t of_layer = (trained.parameters.size() - 3) / 3;
  REQUIRE(changed.parameters.size() == 2 * of_layer + 2);
  CHECK(changed.parameters[2 * of_layer - 1] == static_cast<float>(2 * of_layer - 1));
  CHECK(changed.parameters.back() == static_cast<float>(3 * of_layer + 1));  // of layer 2
}

TEST_CASE("changes of the filter are settings of the loop, and several can be made at once") {
  const nn::Weights trained = three_layers();
  CHECK(network_of(what_if(trained, "no-q"))["filter"]["min_pixels"] == 0);
  CHECK(network_of(what_if(trained, "pixels=9"))["filter"]["min_pixels"] == 9);
  CHECK(network_of(what_if(trained, "angle=7"))["filter"]["min_angle_deg"] == 7.0);
  CHECK(network_of(what_if(trained, "q=z"))["rejected_pixel"] == "takes-h");
  const nlohmann::json both = network_of(what_if(trained, "q=z,y=zero"));
  CHECK(both["filtered_iterate"] == "z");
  CHECK(both["rejected_pixel"] == "zero");
  const nlohmann::json literal = network_of(what_if(trained, "literal"));
  CHECK(literal["filtered_iterate"] == "h");
  CHECK(literal["rejected_pixel"] == "zero");
  CHECK(literal["denoiser"]["neighbours"] == "h");
}

TEST_CASE("a change that there is not is refused in one line") {
  const nn::Weights trained = three_layers();
  CHECK_THROWS_WITH_AS(what_if(trained, "layers=4"),
                       "--what-if layers=4: expected 1 to 3, as many as were trained", Error);
  CHECK_THROWS_WITH_AS(what_if(trained, "b=much"), "--what-if b=much: 'much' is no number", Error);
  CHECK_THROWS_AS(what_if(trained, "b=-1"), Error);
  CHECK_THROWS_AS(what_if(trained, "layers=0"), Error);
  CHECK_THROWS_AS(what_if(trained, "y=1"), Error);
  CHECK_THROWS_WITH_AS(what_if(untrained("du-mix"), "b=1"),
                       "--what-if: du-mix has no such settings, expected weights of du-or", Error);
}

}  // namespace hqslam::tools
