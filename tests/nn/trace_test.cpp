#include "hqslam/nn/trace.h"

#include "hqslam/nn/super_resolver.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

/// What SuperResolver makes of the small scene, and its trace.
struct Traced {
  UpsampledImage upsampled;
  Trace trace;
};

Traced traced_run(const NetworkDescription& description, const RangeImage& scene = small_scene()) {
  SuperResolver resolver(small_weights(description), {});
  Traced traced;
  traced.upsampled = resolver.run(scene, &traced.trace);
  CHECK(resolver.run(scene).image.range_m == traced.upsampled.image.range_m);
  return traced;
}

HqsPlan shallow_du_or() {
  HqsPlan plan = small_du_or();
  plan.layers = 2;
  plan.filter.min_pixels = 4;
  return plan;
}

std::vector<std::string> names_of(const Trace& trace) {
  std::vector<std::string> names;
  for (const TracedTensor& tensor : trace.tensors()) names.push_back(tensor.name);
  return names;
}

}  // namespace

TEST_CASE("DU-OR's trace has every inner tensor by name, in its order") {
  const Traced traced = traced_run(shallow_du_or());
  std::vector<std::string> expected = {"measured", "start"};
  for (const char* layer : {"layers.0.", "layers.1."}) {
    for (const char* what : {"penalty", "h", "encoder.0", "encoder.1", "bottleneck", "decoder.0",
                             "choice.above", "choice.below", "choice.here", "choice.nothing",
                             "choice.correction", "memory", "z", "rejected", "y"}) {
      expected.push_back(std::string(layer) + what);
    }
  }
  expected.insert(expected.end(), {"rejected", "result"});  // of the filter at the end
  CHECK(names_of(traced.trace) == expected);
  const TracedTensor& lower = traced.trace.tensor("layers.1.encoder.1");
  CHECK(lower.channels() == 8);
  CHECK(lower.rows() == 2);
  CHECK(lower.columns() == 8);
  CHECK(lower.unit.empty());
  CHECK(traced.trace.tensor("layers.1.h").unit == "m");
  CHECK(traced.trace.image("result").range_m == traced.upsampled.image.range_m);
  CHECK(traced.trace.tensor("layers.1.penalty").values(0, 0, 0) == doctest::Approx(0.1));
  // The weights of a choice are a softmax, and Z is what they choose.
  const auto value = [&](const char* name, std::size_t i) {
    return traced.trace.tensor(name).all()[i];
  };
  for (std::size_t i = 0; i < 16 * 64; ++i) {
    REQUIRE(value("layers.1.choice.above", i) + value("layers.1.choice.below", i) +
                value("layers.1.choice.here", i) + value("layers.1.choice.nothing", i) ==
            doctest::Approx(1.0));
  }
}

TEST_CASE("Simple DU has no Y, DU-Mix has modes instead of a choice") {
  const Trace simple = traced_run(small_simple_du()).trace;
  CHECK(simple.has("layers.2.convolution.3"));
  CHECK_FALSE(simple.has("layers.2.y"));
  CHECK_FALSE(simple.has("layers.2.rejected"));
  // The penalties are what was learned.
  CHECK(simple.tensor("layers.1.penalty").values(0, 0, 0) == doctest::Approx(0.5 / 10.99));
  CHECK(names_of(traced_run(small_du_mix()).trace) ==
        std::vector<std::string>{
            "measured", "start", "layers.0.h", "layers.0.encoder.0", "layers.0.encoder.1",
            "layers.0.bottleneck.0", "layers.0.bottleneck.1", "layers.0.decoder.0", "mode_1",
            "mode_2", "weight_1", "scale", "probability", "layers.0.z", "confidence", "result"});
}

TEST_CASE("an unknown name is refused with the nearest ones") {
  const Trace trace = traced_run(shallow_du_or()).trace;
  CHECK(refused_with([&] { trace.tensor("layers.9.h"); }, "no tensor 'layers.9.h'",
                     "did you mean 'layers.0.h'"));
  CHECK(refused_with([&] { trace.image("layers.0.encoder.0"); }, "6 channels", "expected 1"));
}

}  // namespace hqslam::nn
