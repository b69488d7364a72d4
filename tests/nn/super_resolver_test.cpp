#include "hqslam/nn/super_resolver.h"

#include "small_network.h"

namespace hqslam::nn {
namespace {

Weights weights_of(HqsPlan plan) {
  plan.filter.min_pixels = 4;
  return small_weights(plan);
}

}  // namespace

TEST_CASE("a range that the sensor cannot measure is no return, and empties nothing beside it") {
  for (const Weights& weights : {weights_of(small_du_or()), small_weights(small_du_mix())}) {
    SuperResolver resolver(weights, {});
    RangeImage scene = select_rows(small_scene(), weights.description.measured_rows);
    scene.at(2, 30) = 0.0F;
    const UpsampledImage expected = resolver.run(scene);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float range_m : {1e6F, 3e38F, kInfinity, std::nanf(""), -5.0F}) {
      CAPTURE(range_m);
      scene.at(2, 30) = range_m;
      const UpsampledImage upsampled = resolver.run(scene);
      CHECK(upsampled.image.range_m == expected.image.range_m);
      CHECK(upsampled.confidence == expected.confidence);
    }
  }
}

TEST_CASE("inside a parallel region of the caller's each object works as it does outside") {
  const TemporaryDirectory directory;
  for (const Weights& weights :
       {weights_of(small_du_or()), weights_of(small_simple_du()), small_weights(small_du_mix())}) {
    const std::string path = directory.file("weights.npz");
    write_weights(path, weights);
    const RangeImage scene = small_scene();
    SuperResolver alone = SuperResolver::load(path, {.threads = 2});
    Trace expected_trace;
    const UpsampledImage expected = alone.run(scene, &expected_trace);
    constexpr int kCallers = 3;
    std::array<std::string, kCallers> complaints;
    std::array<UpsampledImage, kCallers> upsampled;
    std::array<Trace, kCallers> traces;
#pragma omp parallel for num_threads(kCallers) schedule(static, 1)
    for (int i = 0; i < kCallers; ++i) {
      complaints[i] = error_message(
          [&] { upsampled[i] = SuperResolver::load(path, {.threads = 2}).run(scene, &traces[i]); });
    }
    for (int i = 0; i < kCallers; ++i) {
      CHECK(complaints[i] == "no Error");
      CHECK(upsampled[i].image.range_m == expected.image.range_m);
      CHECK(upsampled[i].confidence == expected.confidence);
      REQUIRE(traces[i].tensors().size() == expected_trace.tensors().size());
      for (std::size_t n = 0; n < expected_trace.tensors().size(); ++n) {
        CHECK(std::ranges::equal(traces[i].tensors()[n].all(), expected_trace.tensors()[n].all()));
      }
    }
  }
}

TEST_CASE("an image of another shape is refused with both shapes that would do") {
  SuperResolver resolver(weights_of(small_du_or()), {});
  CHECK(refused_with([&] { resolver.run(RangeImage(5, 64)); }, "5 x 64", "4 or 16 x 64"));
  CHECK(refused_with([&] { resolver.run(RangeImage(4, 32)); }, "4 x 32"));
}

TEST_CASE("the filter at the end can be left out") {
  const Weights weights = weights_of(small_du_or());
  const RangeImage scene = small_scene();
  SuperResolver filtered(weights, {});
  SuperResolver inside_only(weights, {.filter_result = false});
  HqsPlan everything = small_du_or();
  everything.last_filter.min_pixels = 1'000'000;
  SuperResolver strict(weights_of(everything), {});
  const RangeImage image = inside_only.run(scene).image;
  Trace trace;
  const RangeImage without = filtered.run(scene, &trace).image;
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    CHECK(without.range_m[i] ==
          (trace.tensor("rejected").all()[i] != 0.0F ? 0.0F : image.range_m[i]));
  }
  const RangeImage empty = strict.run(scene).image;
  for (int column = 0; column < 64; ++column) CHECK(empty.at(0, column) == 0.0F);
  CHECK(empty.at(3, 0) > 0.0F);
}

TEST_CASE("a weights file is loaded, checked and counted") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("weights.npz");
  const Weights weights = weights_of(small_du_or());
  write_weights(path, weights);
  SuperResolver resolver = SuperResolver::load(path);
  CHECK(resolver.parameters() == static_cast<std::int64_t>(weights.parameters.size()));
  // By hand, per layer: tiles 4 x 16; encoder 19 -> 6 and 6 -> 8, bottleneck 8 -> 8 with 9 taps,
  // decoder 8 -> 6 with 4, head 6 -> 5 * 16 + 3.
  const std::int64_t per_layer =
      64 * (19 * 6 * 9) + 16 * (6 * 8 * 9) + 16 * (8 * 8 * 9) + 16 * (8 * 6 * 4) + 64 * (6 * 83);
  CHECK(resolver.multiply_adds() == 3 * per_layer);
  CHECK(refused_with([&] { SuperResolver::load(directory.file("none.npz")); }, "none.npz"));
}

}  // namespace hqslam::nn
