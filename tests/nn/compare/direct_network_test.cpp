#include "direct_network.h"

#include "golden.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "parameters.h"
#include "small_network.h"
#include "srae.h"
#include "testing.h"
#include "tulip.h"

namespace hqslam::nn {
namespace {

struct NetworkCase {
  std::string name;
  NetworkDescription description;
};

/// As tools/make_golden.py has them.
NetworkCase small_srae() {
  const SraeShape shape{.filters = 1, .passes = 4, .largest_deviation = 0.1875F};
  return {"srae", small_network(std::make_shared<Srae>(shape))};
}
NetworkCase small_tulip() {
  return {"tulip",
          small_network(std::make_shared<Tulip>(TulipShape{.channels = 8, .heads = {2, 2}}))};
}
std::vector<NetworkCase> network_cases() { return {small_srae(), small_tulip()}; }

/// The arrays that a PyTorch module's state dict has, in our order.
std::vector<float> exported(const std::string& name, const std::vector<ParameterShape>& shapes,
                            const std::string& prefix = "") {
  const Golden golden(name);
  std::vector<float> parameters;
  for (const ParameterShape& shape : shapes) {
    const std::vector<float> values = golden.values(prefix + shape.name);
    if (prefix.empty()) CHECK(golden.array(shape.name).shape == shape.shape);
    parameters.insert(parameters.end(), values.begin(), values.end());
  }
  return parameters;
}

std::unique_ptr<Network> network_of(const NetworkCase& c, int threads = 1,
                                    InstructionSet instruction_set = chosen_instruction_set()) {
  return made(c.description, exported("exported_" + c.name, parameter_shapes(c.description)),
              threads, instruction_set);
}

/// Two scans of the golden file.
std::vector<TrainingSample> batch_of(const Golden& golden) {
  const std::vector<float> ranges = golden.values("truth_m");
  std::vector<TrainingSample> batch;
  for (std::size_t begin = 0; begin < ranges.size(); begin += 16 * 64) {
    TrainingSample sample{RangeImage(4, 64), RangeImage(16, 64)};
    std::copy_n(&ranges[begin], 16 * 64, sample.truth.range_m.begin());
    sample.measured = select_rows(sample.truth, {3, 4});
    batch.push_back(sample);
  }
  return batch;
}

}  // namespace

TEST_CASE("SRAE and TULIP equal their PyTorch modules with every instruction set") {
  for (const NetworkCase& c : network_cases()) {
    const Golden golden("exported_" + c.name);
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(c.name);
      CAPTURE(name(instruction_set));
      const auto network = network_of(c, 1, instruction_set);
      const RangeImage estimate = network->estimate(golden.image("self_test.measured"));
      CHECK(relative_error(std::span<const float>(estimate.range_m),
                           golden.values("self_test.expected")) < 1e-4);
    }
  }
}

TEST_CASE("loss and gradients of a batch equal PyTorch's, dropout and batch norm included") {
  for (const NetworkCase& c : network_cases()) {
    CAPTURE(c.name);
    const Golden golden(c.name);
    const std::vector<ParameterShape> shapes = parameter_shapes(c.description);
    const auto network = trainable(c.description, exported("exported_" + c.name, shapes));
    std::vector<float> d_parameters(elements(shapes));
    const double loss = network->add_gradients(batch_of(golden), {},
                                               std::vector<std::uint64_t>{5, 7000}, d_parameters);
    CHECK(loss == doctest::Approx(golden.value("loss")).epsilon(1e-5));
    std::span<float> rest = d_parameters;
    for (const ParameterShape& shape : shapes) {
      CAPTURE(shape.name);
      const std::vector<float> expected = golden.values("d." + shape.name);
      const std::span<float> actual = take(rest, shape.elements());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(actual[i] == doctest::Approx(expected[i]).epsilon(1e-4).scale(0.1));
      }
    }
  }
}

TEST_CASE("SRAE's result is the mean of passes with dropout, empty where they do not agree") {
  const Golden golden("srae");
  const auto network = network_of(small_srae());
  const RangeImage expected = golden.image("passes.range_m");
  const RangeImage measured = select_rows(expected, {3, 4});
  const RangeImage upsampled = network->upsample(measured, 0.5F).image;
  CHECK(relative_error(std::span<const float>(upsampled.range_m), expected.range_m) < 1e-4);
  CHECK(network->trace(measured).image("layers.0.y").range_m == upsampled.range_m);
}

TEST_CASE("one and two threads upsample to the same bits") {
  const RangeImage measured = select_rows(small_scene(), {3, 4});
  for (const NetworkCase& c : network_cases()) {
    const auto one = network_of(c, 1);
    const auto two = network_of(c, 2);
    CHECK(one->upsample(measured, 0.5F).image.range_m ==
          two->upsample(measured, 0.5F).image.range_m);
  }
}

TEST_CASE("the published sizes have the published numbers of parameters and multiply-adds") {
  NetworkDescription os1;
  os1.sensor = sensor_preset("os1-64");
  os1.measured_rows = {3, 4};
  const LayerGraph srae = Srae({.filters = 64}).graph(os1, 1024, Purpose::kUpsampling, {});
  CHECK(elements(srae.parameter_shapes()) == 34'600'001 + 13'952);
  CHECK(static_cast<double>(srae.multiply_adds()) == doctest::Approx(54.4e9).epsilon(0.001));
  const LayerGraph tulip =
      Tulip({.channels = 96, .heads = {3, 6, 12, 24}}).graph(os1, 1024, Purpose::kUpsampling, {});
  CHECK(elements(tulip.parameter_shapes()) == 27'149'076);
  CHECK(static_cast<double>(tulip.multiply_adds()) == doctest::Approx(7.73e9).epsilon(0.02));
}

TEST_CASE("what every pass does alike is done once, and the steps are all that is multiplied") {
  for (const NetworkCase& c : network_cases()) {
    const auto network = network_of(c);
    std::int64_t multiply_adds = 0;
    int most_calls = 0;
    for (const NetworkStep& step : network->steps(select_rows(small_scene(), {3, 4}))) {
      multiply_adds += step.calls * step.multiply_adds;
      most_calls = std::max(most_calls, step.calls);
      if (step.name.starts_with("encoder.0")) CHECK(step.calls == 1);
      step.run();
    }
    CHECK(multiply_adds == network->multiply_adds());
    CHECK(most_calls == (c.name == "srae" ? 4 : 1));
  }
}

TEST_CASE("rows and sizes that do not fit are refused with what would") {
  NetworkDescription srae = small_srae().description;
  srae.measured_rows = {2, 3};
  CHECK(test::refused_with([&] { validate(srae); }, "2 + n 3", "16"));
  NetworkDescription tulip = small_tulip().description;
  tulip.measured_rows = {1, 2};
  CHECK(test::refused_with([&] { validate(tulip); }, "1 + n 2", "16"));
  CHECK(test::refused_with(
      [] {
        Tulip({.channels = 16, .heads = {3, 4}});
      },
      "3 heads", "16 channels"));
  CHECK(test::refused_with([] { Srae({.dropout = 1.0F}); }, "dropout", "1"));
  tulip = small_tulip().description;
  CHECK_THROWS_AS(make_network(tulip, 32, chosen_instruction_set(), 1), Error);  // half a window
}

}  // namespace hqslam::nn
