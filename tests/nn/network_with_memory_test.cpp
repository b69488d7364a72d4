#include "hqslam/nn/network_json.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/training/starting_parameters.h"
#include "small_network.h"

// DU-Mix with what earlier scans measured; its values are held against the reference's in
// reference_test.cpp.
namespace hqslam::nn {

TEST_CASE("a memory takes whole tiles of rows, the last of each of which is measured") {
  CHECK(refused_with([] { small_any_beams({0, 4}, true); }, "the last of every 4"));
  CHECK(refused_with([] { small_any_beams({7, 8}, true); }, "tile.rows", "2 to 4"));
  CHECK(has_scan_memory(network_from_json(network_json(small_du_mix_with_memory()), "file")));
  CHECK_FALSE(has_scan_memory(small_du_mix()));
  CHECK(network_json(small_du_mix()).find("scan_memory") == std::string::npos);
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
    CHECK(refused_with([&] { parameters_to_start_from(from, to, "file"); }, "file"));
  };
  refuses(small_weights(description), plain);
  refuses(small_weights(small_du_or()), description);
}

TEST_CASE("what is recalled in another shape is refused in one line") {
  const NetworkDescription description = small_du_mix_with_memory();
  const RangeImage measured = measured_scene(description);
  SuperResolver resolver(small_weights(description), {});
  RecalledImage recalled = recalled_scene();
  CHECK(resolver.run(measured, recalled).image.rows == 16);
  recalled.weight.pop_back();
  CHECK(refused_with([&] { resolver.run(measured, recalled); }, "1023 weights"));
  recalled = {RangeImage(4, 64), std::vector<float>(4 * 64)};
  CHECK(refused_with([&] { resolver.run(measured, recalled); }, "4 x 64"));
}

}  // namespace hqslam::nn
