#include <cmath>

#include "hqslam/nn/network_json.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/training/starting_parameters.h"
#include "reference_differences.h"
#include "small_network.h"
#include "testing.h"

// DU-Mix with what earlier scans measured (Observation::recalled).
namespace hqslam::nn {
namespace {

NetworkDescription small_du_mix_with_memory() {
  TwoModesShape shape = small_two_modes();
  shape.scan_memory = true;
  return small_du_mix(shape);
}

/// Most pixels of the scene, some of them off, with weights of all sizes.
RecalledImage recalled_scene() {
  RecalledImage recalled{small_scene(), std::vector<float>(16 * 64)};
  const std::vector<float> random = random_values(5, 2 * 16 * 64);
  for (std::size_t i = 0; i < recalled.weight.size(); ++i) {
    const bool there = random[i] > -0.4F && recalled.image.range_m[i] > 0.0F;
    recalled.image.range_m[i] *= there ? 1.0F + 0.1F * random[i] : 0.0F;
    recalled.weight[i] = there ? 4.0F * std::fabs(random[i + 16 * 64]) : 0.0F;
  }
  return recalled;
}

}  // namespace

TEST_CASE("every inner tensor of a network with a memory is that of the reference") {
  const NetworkDescription description = small_du_mix_with_memory();
  const std::vector<float> parameters = large_parameters(description, 9);
  const RangeImage measured = measured_scene(description);
  const RecalledImage recalled = recalled_scene();
  for (const bool with_memory : {true, false}) {
    const Trace trace =
        made(description, parameters)->trace({measured, with_memory ? recalled : RecalledImage()});
    CHECK(trace.has("recalled") == with_memory);
    CHECK(compared_with_reference(description, parameters, trace).size() > 10);
  }
}

TEST_CASE("a network with a memory for any beams equals the reference, whatever rows it computes") {
  for (const RowSelection rows : {RowSelection{3, 4}, RowSelection{1, 2}}) {
    CAPTURE(rows.stride);
    const NetworkDescription description = small_any_beams(rows, true);
    const std::vector<float> parameters = large_start(description);
    const RangeImage measured = select_rows(small_scene(), rows);
    const Trace trace = made(description, parameters)->trace({measured, recalled_scene()});
    const auto differences = differences_from_reference(description, parameters, trace);
    CHECK(differences.size() > 10);
    for (const ReferenceDifference& difference : differences) {
      CAPTURE(difference.name);
      CHECK(difference.largest < 2e-3);
    }
  }
  CHECK(test::refused_with([] { small_any_beams({0, 4}, true); }, "the last of every 4"));
  CHECK(test::refused_with([] { small_any_beams({7, 8}, true); }, "tile.rows", "2 to 4"));
}

TEST_CASE("what is recalled changes computed pixels alone, the same with any number of threads") {
  const NetworkDescription description = small_du_mix_with_memory();
  const std::vector<float> parameters = large_parameters(description, 9);
  const RangeImage measured = measured_scene(description);
  const RecalledImage recalled = recalled_scene();
  const auto network = made(description, parameters);
  const UpsampledImage without = network->upsample(measured, 0.5F);
  const UpsampledImage with = network->upsample({measured, recalled}, 0.5F);
  CHECK(with.image.range_m != without.image.range_m);
  CHECK(select_rows(with.image, description.measured_rows).range_m == measured.range_m);
  CHECK(made(description, parameters, 3)->upsample({measured, recalled}, 0.5F).image.range_m ==
        with.image.range_m);
  CHECK(network->upsample(measured, 0.5F).image.range_m == without.image.range_m);
}

TEST_CASE("a memory that begins with another network's weights begins as that network") {
  const NetworkDescription plain = small_du_mix();
  const NetworkDescription description = small_du_mix_with_memory();
  const Weights weights = small_weights(plain);
  const std::vector<float> parameters = parameters_to_start_from(weights, description, "file");
  const RangeImage measured = measured_scene(plain);
  const UpsampledImage expected = made(plain, weights.parameters)->upsample(measured, 0.5F);
  const UpsampledImage upsampled = made(description, parameters)->upsample(measured, 0.5F);
  for (std::size_t i = 0; i < expected.image.range_m.size(); ++i) {
    REQUIRE(upsampled.image.range_m[i] == doctest::Approx(expected.image.range_m[i]).epsilon(1e-5));
  }
  CHECK(parameters_to_start_from(weights, plain, "file") == weights.parameters);
  const auto refuses = [&](const Weights& from, const NetworkDescription& to) {
    CHECK(test::refused_with([&] { parameters_to_start_from(from, to, "file"); }, "file"));
  };
  refuses(small_weights(description), plain);
  refuses(small_weights(small_du_or()), description);
}

TEST_CASE("the field scan_memory of a recipe and a weights file gives a network a memory") {
  const NetworkDescription description = small_du_mix_with_memory();
  CHECK(has_scan_memory(description));
  CHECK(has_scan_memory(network_from_json(network_json(description), "file")));
  CHECK_FALSE(has_scan_memory(small_du_mix()));
  CHECK(network_json(small_du_mix()).find("scan_memory") == std::string::npos);
}

TEST_CASE("what is recalled in another shape is refused in one line") {
  const NetworkDescription description = small_du_mix_with_memory();
  const RangeImage measured = measured_scene(description);
  SuperResolver resolver(small_weights(description), {});
  RecalledImage recalled = recalled_scene();
  CHECK(resolver.run(measured, recalled).image.rows == 16);
  recalled.weight.pop_back();
  CHECK(test::refused_with([&] { resolver.run(measured, recalled); }, "1023 weights"));
  recalled = {RangeImage(4, 64), std::vector<float>(4 * 64)};
  CHECK(test::refused_with([&] { resolver.run(measured, recalled); }, "4 x 64"));
}

}  // namespace hqslam::nn
