#include "hqs/unrolled_network.h"

#include "error_message.h"
#include "golden.h"
#include "hqs/l1_loss.h"
#include "random_values.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

constexpr double kTolerance = 1e-4;

UnrolledPlan filtered(UnrolledPlan description) {
  description.filter.min_pixels = 30;
  return description;
}

/// Larger than the starting values, so that every part of the network matters.
std::vector<float> parameters_for(const UnrolledPlan& description, std::uint32_t seed) {
  std::vector<float> parameters = initial_parameters(description, seed);
  const std::vector<float> random =
      random_values(seed, static_cast<std::int64_t>(parameters.size()));
  const int penalties = description.penalties();
  for (std::size_t i = 0; i + penalties < parameters.size(); ++i) parameters[i] = 0.3F * random[i];
  return parameters;
}

RangeImage measured_scene(const UnrolledPlan& description) {
  return select_rows(small_scene(), description.measured_rows);
}

Tensor tiles_of(const UnrolledPlan& description, RangeImage image, const Tensor& like) {
  for (float& range : image.range_m) range /= description.range_scale_m;
  Tensor tiles = like;
  to_tiles(image.range_m.data(), description.tile(), tiles);
  return tiles;
}

bool same_bits(const UnrolledState& a, const UnrolledState& b) {
  bool same = a.slots.size() == b.slots.size();
  for (std::size_t i = 0; same && i < a.slots.size(); ++i) {
    same = nn::same_bits(a.slots[i].denoiser.z, b.slots[i].denoiser.z) &&
           nn::same_bits(a.slots[i].denoiser.input(), b.slots[i].denoiser.input()) &&
           nn::same_bits(a.slots[i].y, b.slots[i].y) && a.slots[i].rejected == b.slots[i].rejected;
  }
  return same;
}

/// Every layer's Z, the masks, the loss and the gradients of all parameters.
void check_against_pytorch(const UnrolledPlan& description, const std::string& file) {
  const Golden golden(file);
  const RangeImage measured = golden.image("measured_m");
  const std::vector<float> parameters = golden.fractions("parameters");
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    UnrolledNetwork network(description, 64, instruction_set, 1);
    network.set_parameters(parameters);
    UnrolledState state = network.make_state();
    network.start(measured, state);
    network.forward(state);
    network.finish_last_layer(state);
    for (int layer = 0; layer < 3; ++layer) {
      CAPTURE(layer);
      const std::string prefix = "layers." + std::to_string(layer);
      const LayerState& actual = state.layer(layer);
      CHECK(relative_error(image_of(description, actual.denoiser.z), golden.values(prefix + ".z")) <
            kTolerance);
      if (!golden.has(prefix + ".rejected")) continue;
      std::vector<std::uint8_t> mask;
      for (const std::byte byte : golden.array(prefix + ".rejected").bytes) {
        mask.push_back(static_cast<std::uint8_t>(byte));
      }
      CHECK(actual.rejected == mask);
    }
    const Tensor truth = tiles_of(description, small_scene(), state.z0);
    Tensor d_z = state.z0;
    const double loss = l1_loss(state.slots.back().denoiser.z, truth, description.tile(),
                                description.measured_rows, 1.0F, d_z);
    CHECK(loss == doctest::Approx(golden.value("loss")).epsilon(kTolerance));
    std::vector<float> d_parameters(parameters.size());
    network.backward(state, std::span(&d_z, 1), d_parameters);
    const std::vector<float> expected = golden.values("d_parameters");
    std::size_t next = 0;
    for (const ParameterShape& shape : parameter_shapes(description)) {
      CAPTURE(shape.name);
      const auto count = static_cast<std::size_t>(shape.elements());
      const auto first = expected.begin() + static_cast<std::ptrdiff_t>(next);
      const std::vector<float> part(first, first + static_cast<std::ptrdiff_t>(count));
      CHECK(relative_error(std::span(d_parameters).subspan(next, count), part) < kTolerance);
      next += count;
    }
  }
}

}  // namespace

TEST_CASE("DU-OR with its own weights in each layer equals PyTorch, gradients included") {
  check_against_pytorch(small_du_or(), "du_or");
}

TEST_CASE("DU-OR with shared weights and the filter inside equals PyTorch with its own search") {
  UnrolledPlan description = filtered(small_du_or());
  description.shared_weights = true;
  description.u_shaped.negative_slope = 0.125F;
  check_against_pytorch(description, "du_or_filtered");
}

TEST_CASE("Simple DU equals PyTorch, gradients included") {
  check_against_pytorch(small_simple_du(), "simple_du");
}

TEST_CASE("one and two threads give the same bits") {
  for (const UnrolledPlan& description : {filtered(small_du_or()), small_simple_du()}) {
    for (const InstructionSet any : available_instruction_sets()) {
      const std::vector<float> parameters = parameters_for(description, 1);
      const RangeImage measured = measured_scene(description);
      CHECK(same_bits(state_after(description, parameters, measured, any, 1),
                      state_after(description, parameters, measured, any, 2)));
    }
  }
}

TEST_CASE("what was in the state before does not matter, backwards neither") {
  for (const UnrolledPlan& description : {filtered(small_du_or()), small_simple_du()}) {
    const std::vector<float> parameters = parameters_for(description, 2);
    const RangeImage measured = measured_scene(description);
    RangeImage other = measured;
    for (float& range : other.range_m) range = 40.0F - 0.5F * range;
    UnrolledNetwork network(description, 64, chosen_instruction_set(), 1);
    network.set_parameters(parameters);
    const auto run = [&](const RangeImage& scan, UnrolledState& state) {
      network.start(scan, state);
      network.forward(state);
      network.finish_last_layer(state);
      std::vector<float> gradient(parameters.size());
      network.backward(state, std::span(&state.slots.back().denoiser.z, 1), gradient);
      return gradient;
    };
    UnrolledState fresh = network.make_state();
    const std::vector<float> first = run(measured, fresh);
    UnrolledState used = network.make_state();
    const std::vector<float> between = run(other, used);
    CHECK(between != first);
    CHECK(run(measured, used) == first);
    CHECK(same_bits(used, fresh));
    CHECK(same_bits(fresh, state_after(description, parameters, measured)));
  }
}

TEST_CASE("what stands in the borders of d loss / d Z does not matter") {
  for (const UnrolledPlan& description : {filtered(small_du_or()), small_simple_du()}) {
    const std::vector<float> parameters = parameters_for(description, 8);
    UnrolledNetwork network(description, 40, chosen_instruction_set(), 1);
    network.set_parameters(parameters);
    UnrolledState state = network.make_state();
    RangeImage measured(4, 40);
    for (int i = 0; i < 4 * 40; ++i) measured.range_m[i] = small_scene().range_m[i];
    network.start(measured, state);
    network.forward(state);
    std::vector<Tensor> d_z(1, state.z0);
    fill_random(1, d_z[0]);
    std::vector<float> clean(parameters.size());
    network.backward(state, d_z, clean);
    for (int c = 0; c < d_z[0].channels(); ++c) {
      for (int y = 0; y < d_z[0].rows(); ++y) {
        float* row = d_z[0].row(c, y);
        std::fill(row - Tensor::kBorderColumns, row, 1e6F);
        std::fill(row + d_z[0].columns(), row + d_z[0].padded_columns() + Tensor::kBorderColumns,
                  1e6F);
      }
    }
    std::vector<float> soiled(parameters.size());
    network.backward(state, d_z, soiled);
    CHECK(soiled == clean);
    CHECK_THROWS_AS(network.backward(state, {}, soiled), Error);
    CHECK_THROWS_AS(network.backward(state, std::vector<Tensor>(4, state.z0), soiled), Error);
  }
}

TEST_CASE("the first layers do not depend on how many come after them") {
  UnrolledPlan description = filtered(small_du_or());
  const std::vector<float> parameters = parameters_for(description, 3);
  const RangeImage measured = measured_scene(description);
  const UnrolledState three = state_after(description, parameters, measured);
  REQUIRE(three.slots.size() == 3);
  description.layers = 2;
  const std::size_t of_one = (parameters.size() - 3) / 3;
  std::vector<float> fewer(parameters.begin(),
                           parameters.begin() + static_cast<std::ptrdiff_t>(2 * of_one));
  fewer.insert(fewer.end(), parameters.end() - 3, parameters.end() - 1);
  const UnrolledState two = state_after(description, fewer, measured);
  REQUIRE(two.slots.size() == 2);
  for (int layer = 0; layer < 2; ++layer) {
    CHECK(nn::same_bits(two.layer(layer).denoiser.z, three.layer(layer).denoiser.z));
    CHECK(nn::same_bits(two.layer(layer).y, three.layer(layer).y));
  }
}

TEST_CASE("a state that keeps two layers has the same result; backward refuses it") {
  for (const UnrolledPlan& description : {filtered(small_du_or()), small_simple_du()}) {
    const std::vector<float> parameters = parameters_for(description, 7);
    UnrolledNetwork network(description, 64, chosen_instruction_set(), 1);
    network.set_parameters(parameters);
    UnrolledState state = network.make_state(UnrolledNetwork::Kept::kLastTwo);
    RangeImage measured = measured_scene(description);
    for (float& range : measured.range_m) range *= 2.0F;  // leaves something in the state
    network.start(measured, state);
    network.forward(state);
    network.start(measured_scene(description), state);
    network.forward(state);
    const UnrolledState all = state_after(description, parameters, measured_scene(description));
    CHECK(nn::same_bits(network.result(state), network.result(all)));
    std::vector<float> gradient(parameters.size());
    CHECK_THROWS_AS(network.backward(state, std::span(&state.z0, 1), gradient), Error);
  }
}

TEST_CASE("a small penalty keeps measured rows at L, a large one lets them go") {
  const UnrolledPlan description = small_du_or();
  const RangeImage measured = measured_scene(description);
  const auto distance_m = [&](float penalty) {
    std::vector<float> parameters = parameters_for(description, 4);
    std::fill(parameters.end() - 3, parameters.end(), std::log(penalty));
    const UnrolledState state = state_after(description, parameters, measured);
    const std::vector<float> h = image_of(description, state.slots.back().denoiser.input());
    double sum_m = 0.0;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 64; ++column) {
        sum_m += std::fabs(80.0 * h[(4 * row + 3) * 64 + column] - measured.at(row, column));
      }
    }
    return sum_m / (4 * 64);
  };
  CHECK(distance_m(1e-6F) < 1e-3);
  CHECK(distance_m(0.01F) < distance_m(0.1F));
  CHECK(distance_m(0.1F) < distance_m(10.0F));
}

TEST_CASE("the start is L, its measured neighbours and their interpolation; zero for Simple DU") {
  const UnrolledPlan description = small_du_or();
  UnrolledNetwork network(description, 64, chosen_instruction_set(), 1);
  UnrolledState state = network.make_state();
  const RangeImage measured = measured_scene(description);
  network.start(measured, state);
  const std::vector<float> z0 = image_of(description, state.z0);
  CHECK(80.0 * z0[5 * 64 + 33] == doctest::Approx(0.5 * (measured.at(0, 33) + measured.at(1, 33))));
  CHECK(80.0 * z0[0 * 64 + 33] == doctest::Approx(measured.at(0, 33)));
  CHECK(80.0 * image_of(description, state.candidates.above)[6 * 64 + 9] ==
        doctest::Approx(measured.at(0, 9)));
  CHECK(80.0 * image_of(description, state.candidates.below)[4 * 64 + 9] ==
        doctest::Approx(measured.at(1, 9)));
  CHECK(80.0 * image_of(description, state.l)[7 * 64 + 9] == doctest::Approx(measured.at(1, 9)));

  UnrolledNetwork simple(small_simple_du(), 64, chosen_instruction_set(), 1);
  UnrolledState simple_state = simple.make_state();
  simple.start(measured, simple_state);
  for (const float value : image_of(small_simple_du(), simple_state.z0)) REQUIRE(value == 0.0F);
}

TEST_CASE("Y is H or Z, and Z or 0 where the filter rejects, as the description says") {
  for (const FilteredIterate iterate : {FilteredIterate::kH, FilteredIterate::kZ}) {
    for (const RejectedPixel pixel : {RejectedPixel::kTakesZ, RejectedPixel::kZero}) {
      UnrolledPlan d = filtered(small_du_or());
      d.filtered = iterate;
      d.rejected = pixel;
      const UnrolledState state = state_after(d, parameters_for(d, 5), measured_scene(d));
      for (const LayerState& layer : state.slots) {
        const std::vector<float> h = image_of(d, layer.denoiser.input());
        const std::vector<float> z = image_of(d, layer.denoiser.z);
        const std::vector<float> y = image_of(d, layer.y);
        const std::vector<float>& source = iterate == FilteredIterate::kH ? h : z;
        std::vector<float> seen = source;  // nearer than 0.5 m the sensor sees nothing
        for (float& range : seen) range = range >= 0.5F / 80.0F ? range : 0.0F;
        std::vector<std::uint8_t> expected_mask(y.size());
        OutlierRemoval(d.sensor, d.measured_rows, d.filter, 64)
            .find(seen.data(), expected_mask.data());
        REQUIRE(layer.rejected == expected_mask);
        int rejected = 0;
        for (std::size_t i = 0; i < y.size(); ++i) {
          rejected += layer.rejected[i];
          const float instead = pixel == RejectedPixel::kZero ? 0.0F : z[i];
          REQUIRE(y[i] == (layer.rejected[i] != 0 ? instead : source[i]));
        }
        CHECK(rejected > 0);
        CHECK(rejected < 16 * 64);
      }
    }
  }
}

TEST_CASE(
    "the result does not change when min_pixels 0 switches a filter off that rejects nothing") {
  UnrolledPlan description = small_du_or();
  const std::vector<float> parameters = parameters_for(description, 6);
  const UnrolledState off = state_after(description, parameters, measured_scene(description));
  description.filter.min_pixels = 1;
  CHECK(same_bits(off, state_after(description, parameters, measured_scene(description))));
  for (const std::uint8_t rejected : off.slots.back().rejected) REQUIRE(rejected == 0);
}

TEST_CASE("scans, columns and parameters that do not fit are refused") {
  const UnrolledPlan description = small_du_or();
  const InstructionSet any = chosen_instruction_set();
  const auto message = [&](int columns) {
    return test::error_message([&] { make_network(description, columns, any, 1); });
  };
  CHECK(message(32) == "no Error");
  CHECK(test::one_line_with(message(0), "0 columns", "1 to 64"));
  CHECK(test::one_line_with(message(128), "128 columns", "1 to 64"));
  CHECK(test::one_line_with(message(60), "60 columns", "multiple of 8"));
  UnrolledNetwork network(description, 64, any, 1);
  std::vector<float> parameters = initial_parameters(description, 1);
  parameters.pop_back();
  CHECK(test::one_line_with(test::error_message([&] { network.set_parameters(parameters); }),
                            std::to_string(parameters.size()),
                            std::to_string(parameters.size() + 1)));
  UnrolledState state = network.make_state();
  CHECK_THROWS_AS(network.start(RangeImage(16, 64), state), Error);
  CHECK(test::one_line_with(test::error_message([&] { network.start(RangeImage(4, 32), state); }),
                            "4 x 32", "64"));
  CHECK_THROWS_AS(network.start(RangeImage(4, 128), state), Error);
}

TEST_CASE("a loss on an inner layer has the gradient of the network that ends there") {
  UnrolledPlan two = small_du_or();
  two.layers = 2;
  const UnrolledPlan three = small_du_or();
  const std::vector<float> parameters = initial_parameters(three, 4);
  const std::size_t of_layer = (parameters.size() - 3) / 3;
  std::vector<float> fewer(parameters.begin(), parameters.begin() + 2 * of_layer);
  fewer.insert(fewer.end(), parameters.end() - 3, parameters.end() - 1);
  const RangeImage measured = select_rows(small_scene(), three.measured_rows);
  const UnrolledState state = state_after(three, parameters, measured);
  Tensor d_inner = state.z0;
  fill_random(5, d_inner);
  Tensor nothing = state.z0;
  nothing.set_zero();
  UnrolledNetwork whole(three, 64, chosen_instruction_set(), 1);
  whole.set_parameters(parameters);
  std::vector<float> gradient(parameters.size());
  whole.backward(state, std::vector<Tensor>{d_inner, nothing}, gradient);
  UnrolledNetwork shorter(two, 64, chosen_instruction_set(), 1);
  shorter.set_parameters(fewer);
  std::vector<float> expected(fewer.size());
  shorter.backward(state_after(two, fewer, measured), std::span(&d_inner, 1), expected);
  for (std::size_t i = 0; i < 2 * of_layer; ++i) {
    REQUIRE(gradient[i] == doctest::Approx(expected[i]).epsilon(1e-5).scale(1e-3));
  }
  CHECK(gradient[3 * of_layer + 1] == doctest::Approx(expected[2 * of_layer + 1]));
  for (std::size_t i = 2 * of_layer; i < 3 * of_layer; ++i) REQUIRE(gradient[i] == 0.0F);
}

}  // namespace hqslam::nn
