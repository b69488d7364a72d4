#include "srae.h"

#include "golden.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

/// As tools/make_golden.py has it.
NetworkDescription small_srae() {
  return small_network(
      std::make_shared<Srae>(SraeShape{.filters = 1, .passes = 4, .largest_deviation = 0.1875F}));
}

/// The arrays that a PyTorch module's state dict has, in our order.
std::vector<float> exported() {
  const Golden golden("exported_srae");
  std::vector<float> parameters;
  for (const ParameterShape& shape : parameter_shapes(small_srae())) {
    const std::vector<float> values = golden.values(shape.name);
    CHECK(golden.array(shape.name).shape == shape.shape);
    parameters.insert(parameters.end(), values.begin(), values.end());
  }
  return parameters;
}

std::unique_ptr<Network> network_of(int threads = 1,
                                    InstructionSet instruction_set = chosen_instruction_set()) {
  return made(small_srae(), exported(), threads, instruction_set);
}

}  // namespace

TEST_CASE("SRAE equals its PyTorch module with every instruction set") {
  const Golden golden("exported_srae");
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    const RangeImage estimate =
        network_of(1, instruction_set)->estimate(golden.image("self_test.measured"));
    CHECK(relative_error(std::span<const float>(estimate.range_m),
                         golden.values("self_test.expected")) < 1e-4);
  }
}

TEST_CASE("loss and gradients of a batch equal PyTorch's, dropout and batch norm included") {
  const Golden golden("srae");
  const std::vector<float> ranges = golden.values("truth_m");
  std::vector<TrainingSample> batch;  // of two scans
  for (std::size_t begin = 0; begin < ranges.size(); begin += 16 * 64) {
    TrainingSample sample{RangeImage(4, 64), RangeImage(16, 64)};
    std::copy_n(&ranges[begin], 16 * 64, sample.truth.range_m.begin());
    sample.measured = select_rows(sample.truth, {3, 4});
    batch.push_back(sample);
  }
  const std::vector<ParameterShape> shapes = parameter_shapes(small_srae());
  const auto network = trainable(small_srae(), exported());
  std::vector<float> d_parameters(elements(shapes));
  const double loss =
      network->add_gradients(batch, {}, std::vector<std::uint64_t>{5, 7000}, d_parameters);
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

TEST_CASE("SRAE's result is the mean of passes with dropout, empty where they do not agree") {
  const auto network = network_of();
  const RangeImage expected = Golden("srae").image("passes.range_m");
  const RangeImage measured = select_rows(expected, {3, 4});
  const RangeImage upsampled = network->upsample(measured, 0.5F).image;
  CHECK(network_of(2)->upsample(measured, 0.5F).image.range_m == upsampled.range_m);
  CHECK(relative_error(std::span<const float>(upsampled.range_m), expected.range_m) < 1e-4);
  CHECK(network->trace(measured).image("layers.0.y").range_m == upsampled.range_m);
}

TEST_CASE("the published size has the published numbers of parameters and multiply-adds") {
  NetworkDescription os1;
  os1.sensor = sensor_preset("os1-64");
  os1.measured_rows = {3, 4};
  const LayerGraph srae = Srae({.filters = 64}).graph(os1, 1024, {});
  CHECK(elements(srae.parameter_shapes()) == 34'600'001 + 13'952);
  CHECK(static_cast<double>(srae.multiply_adds()) == doctest::Approx(54.4e9).epsilon(0.001));
}

TEST_CASE("rows and sizes that do not fit are refused with what would") {
  NetworkDescription srae = small_srae();
  srae.measured_rows = {2, 3};
  CHECK(refused_with([&] { validate(srae); }, "2 + n 3", "16"));
  CHECK(refused_with([] { Srae({.dropout = 1.0F}); }, "dropout", "1"));
  CHECK_THROWS_AS(make_network(small_srae(), 40, chosen_instruction_set(), 1), Error);
}

}  // namespace hqslam::nn
