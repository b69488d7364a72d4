#include <nlohmann/json.hpp>

#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/trace.h"
#include "inspect/what_if.h"
#include "tools/program/untrained_weights.h"

extern "C" {
const char* parameter_names(const char* description);
void set_parameters(const float* values, int count);
const char* change_network(const char* change);
const char* upsample(const float* measured_m, int rows, int columns, int traced);
const float* result_ranges();
const float* tensor(const char* name);
}

namespace hqslam::test {

TEST_CASE("a page's engine gives the network's result, as trained and with a changed loop") {
  const nn::Weights weights = untrained_weights(preset_with("os1-64", 64), "du-or");
  const RangeImage& measured = weights.self_test.measured;
  const nlohmann::json names =
      nlohmann::json::parse(parameter_names(nn::network_json(weights.description).c_str()));
  CHECK(names.size() == nn::parameter_shapes(weights.description).size());
  CHECK(names.back() == "log_penalty");
  set_parameters(weights.parameters.data(), static_cast<int>(weights.parameters.size()));
  for (const std::string change : {"", "b=0.5,no-q"}) {
    CAPTURE(change);
    CHECK(std::string(change_network(change.c_str())) == "");
    CHECK(std::string(upsample(measured.range_m.data(), measured.rows, measured.columns, 1)) == "");
    nn::Trace trace;
    nn::SuperResolver network(change.empty() ? weights : tools::what_if(weights, change), {});
    const RangeImage expected = network.run(measured, &trace).image;
    CHECK(std::equal(expected.range_m.begin(), expected.range_m.end(), result_ranges()));
    CHECK(std::ranges::equal(trace.tensor("layers.1.z").all(),
                             std::span(tensor("layers.1.z"), expected.range_m.size())));
  }
  CHECK(tensor("layers.7.z") == nullptr);
  CHECK(std::string(change_network("b=x")) == "--what-if b=x: 'x' is no number");
  CHECK(std::string(upsample(measured.range_m.data(), 3, measured.columns, 0)) != "");
}

}  // namespace hqslam::test
