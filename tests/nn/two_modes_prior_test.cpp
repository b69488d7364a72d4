#include "golden.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

constexpr double kPriorTolerance = 1e-4;

/// The computed pixels of an image as PyTorch's side stores them: row of the tile, tile row,
/// column.
std::vector<float> computed_pixels(const std::vector<float>& image) {
  std::vector<float> pixels;
  for (int of_tile = 0; of_tile < 3; ++of_tile) {
    for (int tile_row = 0; tile_row < 4; ++tile_row) {
      const auto row = image.begin() + 64 * (tile_row * 4 + of_tile);
      pixels.insert(pixels.end(), row, row + 64);
    }
  }
  return pixels;
}

void check_against_pytorch(NetworkDescription description, const std::string& file) {
  const Golden golden(file);
  description.sensor.min_range_m = 1e-6;  // the file has every range that came out
  description.sensor.max_range_m = 1e6;
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    const auto network = made(description, golden.fractions("parameters"), 1, instruction_set);
    const RangeImage measured = golden.image("measured_m");
    RecalledImage recalled;
    if (golden.has("weight")) recalled = {golden.image("recalled_m"), golden.values("weight")};
    const UpsampledImage& upsampled = network->upsample({measured, recalled}, 0.5F);
    CHECK(relative_error(computed_pixels(upsampled.image.range_m), golden.values("range_m")) <
          kPriorTolerance);
    CHECK(relative_error(computed_pixels(upsampled.confidence), golden.values("confidence")) <
          kPriorTolerance);
    const std::vector<float> expected = golden.values("d_parameters");
    std::vector<float> d_parameters(expected.size());
    const double loss =
        add_gradient(*trainable(description, golden.fractions("parameters"), instruction_set),
                     {measured, small_scene(), recalled}, d_parameters);
    CHECK(loss == doctest::Approx(golden.value("loss")).epsilon(kPriorTolerance));
    check_arrays(d_parameters, expected, parameter_shapes(description), 2e-4);
  }
}

}  // namespace

TEST_CASE("DU-Mix equals PyTorch, with a memory too: ranges, confidence, loss and gradients") {
  check_against_pytorch(small_du_mix(), "du_mix");
  TwoModesShape with_memory = small_two_modes();
  with_memory.scan_memory = true;
  check_against_pytorch(small_du_mix(with_memory), "du_mix_memory");
}

TEST_CASE("the gradients of DU-Mix for any beams are the slopes of its loss") {
  const NetworkDescription description = small_any_beams({1, 4});
  std::vector<float> parameters = large_start(description);
  const TrainingSample sample{select_rows(small_scene(), description.measured_rows), small_scene()};
  std::vector<float> gradient(parameters.size());
  const auto loss = [&](std::span<float> d_parameters) {
    return add_gradient(*trainable(description, parameters, chosen_instruction_set()), sample,
                        d_parameters);
  };
  loss(gradient);
  std::size_t first = 0;
  for (const ParameterShape& shape : parameter_shapes(description)) {
    CAPTURE(shape.name);
    const auto count = static_cast<std::size_t>(shape.elements());
    const auto largest =
        std::ranges::max_element(gradient.begin() + first, gradient.begin() + first + count,
                                 [](float a, float b) { return std::fabs(a) < std::fabs(b); });
    REQUIRE(std::fabs(*largest) > 0.0F);
    float& parameter = parameters[largest - gradient.begin()];
    std::vector<float> unused(parameters.size());
    CHECK(*largest ==
          doctest::Approx(slope_of([&] { return loss(unused); }, 2e-3F, parameter)).epsilon(0.02));
    first += count;
  }
}

TEST_CASE("a network of one sensor refuses another one, and one for any beams takes it") {
  const NetworkDescription one = small_du_mix();
  CHECK_FALSE(fits_any_sensor(one));
  CHECK(refused_with([&] { for_sensor(one, one.sensor, {1, 2}); }, "expected one for any"));
  const NetworkDescription any = small_any_beams({3, 4});
  CHECK(fits_any_sensor(any));
  const NetworkDescription other = for_sensor(any, any.sensor, {1, 2});
  CHECK(elements(parameter_shapes(other)) == elements(parameter_shapes(any)));
  SensorModel odd = any.sensor;
  odd.beam_elevation_rad.resize(12);
  odd.beam_azimuth_offset_rad.resize(12);
  CHECK(refused_with([&] { for_sensor(any, odd, {3, 4}); }, "even number", "found 3"));
}

TEST_CASE("the loss is the mean over the columns, where they are no whole vectors too") {
  // Outputs of 0 are: a return with probability 1/2, two modes at the interpolated range, whose
  // scale is e^-3.5.
  const NetworkDescription description = small_du_mix();
  const std::vector<float> nothing(elements(parameter_shapes(description)));
  const RangeImage walls = flat_image(16, 40, 10.0F);  // ten tiles a row
  const RangeImage measured = select_rows(walls, description.measured_rows);
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    const auto network = trainable(description, nothing, instruction_set, 40);
    std::vector<float> d_parameters(nothing.size());
    const auto loss = [&](const RangeImage& truth) {
      return add_gradient(*network, {measured, truth}, d_parameters);
    };
    CHECK(loss(RangeImage(16, 40)) == doctest::Approx(std::log(2.0)).epsilon(1e-5));
    CHECK(loss(walls) == doctest::Approx(std::log(2.0) - 0.3 * 3.5).epsilon(1e-5));
  }
}

TEST_CASE("measured rows come out as they were, their returns with confidence 1") {
  const NetworkDescription description = small_du_mix();
  RangeImage measured = measured_scene(description);
  measured.at(1, 7) = 0.0F;
  measured.at(2, 9) = std::numeric_limits<float>::quiet_NaN();
  measured.at(2, 10) = std::numeric_limits<float>::infinity();
  measured.at(3, 11) = -4.0F;
  const auto network = made(description, initial_parameters(description, 3));
  const UpsampledImage& upsampled = network->upsample(measured, 0.5F);
  for (int row = 0; row < measured.rows; ++row) {
    for (int column = 0; column < 64; ++column) {
      const float range_m = measured.at(row, column);
      const bool there = range_m > 0.0F && std::isfinite(range_m);
      const std::size_t pixel = upsampled.image.index(3 + 4 * row, column);
      REQUIRE(upsampled.image.range_m[pixel] == (there ? range_m : 0.0F));
      REQUIRE(upsampled.confidence[pixel] == (there ? 1.0F : 0.0F));
    }
  }
  for (std::size_t i = 0; i < upsampled.confidence.size(); ++i) {
    REQUIRE(std::isfinite(upsampled.image.range_m[i]));
    REQUIRE(upsampled.confidence[i] >= 0.0F);
    REQUIRE(upsampled.confidence[i] <= 1.0F);
  }
}

TEST_CASE("the confidence grows with the tolerance, and its exponent is that of a power") {
  NetworkDescription description = small_du_mix();
  const RangeImage measured = measured_scene(description);
  const auto network = made(description, initial_parameters(description, 3));
  const std::vector<float> narrow = network->upsample(measured, 0.05F).confidence;
  const std::vector<float> wide = network->upsample(measured, 0.5F).confidence;
  description.confidence_exponent = 2.0F;
  const auto squaring = made(description, initial_parameters(description, 3));
  const std::vector<float> squares = squaring->upsample(measured, 0.5F).confidence;
  double gain = 0.0;
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    REQUIRE(wide[i] >= narrow[i] - 1e-6F);
    REQUIRE(std::abs(squares[i] - wide[i] * wide[i]) < 1e-5F);
    gain += wide[i] - narrow[i];
  }
  CHECK(gain > 0.01 * static_cast<double>(narrow.size()));
}

TEST_CASE("a DU-Mix that cannot be is refused with the field") {
  TwoModesShape bad = small_two_modes();
  bad.tile.rows = 2;
  CHECK(refused_with([&] { validate(small_du_mix(bad)); }, "tiles of 2 rows", "one measured row"));
  TwoModesShape senseless = small_two_modes();
  senseless.channels = 0;
  CHECK(refused_with([&] { small_du_mix(senseless); }, "channels is 0"));
}

}  // namespace hqslam::nn
