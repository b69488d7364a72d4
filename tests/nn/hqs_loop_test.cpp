#include "hqs/hqs_loop.h"

#include "golden.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

constexpr double kLoopTolerance = 1e-4;

HqsPlan filtered(HqsPlan plan) {
  plan.filter.min_pixels = 30;
  return plan;
}

/// The gradient after a scan, with Z for d loss / d Z.
std::vector<float> gradient_after(const RangeImage& scan, HqsRun& run, std::size_t parameters) {
  send(scan, 1, run);
  std::vector<float> gradient(parameters);
  add_gradient(run, std::span(&run.z(run.hqs.layers - 1), 1), gradient);
  return gradient;
}

bool same_bits(const HqsRun& a, const HqsRun& b) {
  bool same = a.state.slots.size() == b.state.slots.size();
  for (std::size_t i = 0; same && i < a.state.slots.size(); ++i) {
    const HqsLayer& of_a = a.state.slots[i];
    const HqsLayer& of_b = b.state.slots[i];
    same = nn::same_bits(of_a.prior.z, of_b.prior.z) &&
           nn::same_bits(of_a.prior.input(), of_b.prior.input()) && nn::same_bits(of_a.y, of_b.y) &&
           of_a.rejected == of_b.rejected;
  }
  return same;
}

/// With the parameters of one layer in all of them.
std::vector<float> repeated(const std::vector<float>& shared, int layers) {
  const auto of_one = shared.end() - layers;
  std::vector<float> parameters;
  for (int k = 0; k < layers; ++k) parameters.insert(parameters.end(), shared.begin(), of_one);
  parameters.insert(parameters.end(), of_one, shared.end());
  return parameters;
}

/// The gradient of what `repeated` repeats.
std::vector<float> summed(const std::vector<float>& gradient, int layers) {
  const std::size_t of_one = (gradient.size() - layers) / layers;
  std::vector<float> sum(of_one);
  for (std::size_t i = 0; i < of_one * layers; ++i) sum[i % of_one] += gradient[i];
  sum.insert(sum.end(), gradient.end() - layers, gradient.end());
  return sum;
}

/// Every layer's Z, the masks, the loss and the gradients of all parameters.
void check_against_pytorch(const HqsPlan& plan, const std::string& file, bool repeats = false) {
  const Golden golden(file);
  std::vector<float> parameters = golden.fractions("parameters");
  if (repeats) parameters = repeated(parameters, plan.layers);
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    HqsRun run = run_of(plan, parameters, golden.image("measured_m"), instruction_set);
    for (int layer = 0; layer < 3; ++layer) {
      CAPTURE(layer);
      const std::string prefix = "layers." + std::to_string(layer);
      CHECK(relative_error(image_of(plan, run.z(layer)), golden.values(prefix + ".z")) <
            kLoopTolerance);
      if (!golden.has(prefix + ".rejected")) continue;
      std::vector<std::uint8_t> mask;
      for (const std::byte byte : golden.array(prefix + ".rejected").bytes) {
        mask.push_back(static_cast<std::uint8_t>(byte));
      }
      CHECK(run.layer(layer).rejected == mask);
    }
    Tensor truth = run.hqs.z0;
    HqsGradient(run.hqs).backward(0).put_truth(small_scene(), plan.range_scale_m, truth);
    Tensor d_z = run.hqs.z0;
    const double loss = l1_loss(run.z(2), truth, plan.tile(), plan.measured_rows, 1.0F, d_z);
    CHECK(loss == doctest::Approx(golden.value("loss")).epsilon(kLoopTolerance));
    std::vector<float> d_parameters(parameters.size());
    add_gradient(run, std::span(&d_z, 1), d_parameters);
    const std::vector<float> expected = golden.values("d_parameters");
    if (repeats) {
      CHECK(relative_error(summed(d_parameters, plan.layers), expected) < kLoopTolerance);
      continue;
    }
    check_arrays(d_parameters, expected, parameter_shapes(plan), kLoopTolerance);
  }
}

}  // namespace

TEST_CASE("DU-OR, also with shared weights and the filter inside, and Simple DU equal PyTorch") {
  check_against_pytorch(small_du_or(), "du_or");
  HqsPlan shared = filtered(small_du_or());
  shared.u_shaped.negative_slope = 0.125F;
  check_against_pytorch(shared, "du_or_filtered", true);
  check_against_pytorch(small_simple_du(), "simple_du");
}

TEST_CASE("what was in the state before does not matter, backwards neither") {
  for (const HqsPlan& plan : {filtered(small_du_or()), small_simple_du()}) {
    const std::vector<float> parameters = large_parameters(plan, 2);
    const RangeImage measured = measured_scene(plan);
    RangeImage other = measured;
    for (float& range : other.range_m) range = 40.0F - 0.5F * range;
    HqsRun fresh = run_of(plan, parameters, measured);
    const std::vector<float> first = gradient_after(measured, fresh, parameters.size());
    HqsRun used = run_of(plan, parameters, other);
    CHECK(gradient_after(other, used, parameters.size()) != first);
    CHECK(gradient_after(measured, used, parameters.size()) == first);
    CHECK(same_bits(used, fresh));
    CHECK(same_bits(fresh, run_of(plan, parameters, measured)));
  }
}

}  // namespace hqslam::nn
