#include "hqs/hqs_loop.h"

#include "error_message.h"
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

TEST_CASE("DU-OR with its own weights in each layer equals PyTorch, gradients included") {
  check_against_pytorch(small_du_or(), "du_or");
}

TEST_CASE(
    "DU-OR with one layer's weights in all and the filter inside equals PyTorch's own search") {
  HqsPlan plan = filtered(small_du_or());
  plan.u_shaped.negative_slope = 0.125F;
  check_against_pytorch(plan, "du_or_filtered", true);
}

TEST_CASE("Simple DU equals PyTorch, gradients included") {
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

TEST_CASE("what stands in the borders of d loss / d Z does not matter") {
  for (const HqsPlan& plan : {filtered(small_du_or()), small_simple_du()}) {
    const std::vector<float> parameters = large_parameters(plan, 8);
    RangeImage measured(4, 40);
    for (int i = 0; i < 4 * 40; ++i) measured.range_m[i] = small_scene().range_m[i];
    HqsRun run = run_of(plan, parameters, measured);
    Tensor d_z = run.hqs.z0;
    fill_random(1, d_z);
    std::vector<float> clean(parameters.size());
    add_gradient(run, std::span(&d_z, 1), clean);
    for (int c = 0; c < d_z.channels(); ++c) {
      for (int y = 0; y < d_z.rows(); ++y) {
        float* row = d_z.row(c, y);
        std::fill(row - Tensor::kBorderColumns, row, 1e6F);
        std::fill(row + d_z.columns(), row + d_z.padded_columns() + Tensor::kBorderColumns, 1e6F);
      }
    }
    std::vector<float> soiled(parameters.size());
    add_gradient(run, std::span(&d_z, 1), soiled);
    CHECK(soiled == clean);
  }
}

TEST_CASE("the first layers do not depend on how many come after them, nor do their gradients") {
  HqsPlan three = filtered(small_du_or());
  HqsPlan two = three;
  two.layers = 2;
  const std::vector<float> parameters = large_parameters(three, 3);
  const std::size_t of_one = (parameters.size() - 3) / 3;
  std::vector<float> fewer(parameters.begin(),
                           parameters.begin() + static_cast<std::ptrdiff_t>(2 * of_one));
  fewer.insert(fewer.end(), parameters.end() - 3, parameters.end() - 1);
  HqsRun whole = run_of(three, parameters, measured_scene(three));
  HqsRun shorter = run_of(two, fewer, measured_scene(two));
  for (int k = 0; k < 2; ++k) {
    CHECK(nn::same_bits(shorter.z(k), whole.z(k)));
    CHECK(nn::same_bits(shorter.layer(k).y, whole.layer(k).y));
  }
  // A loss on an inner layer has the gradient of the network that ends there.
  Tensor d_inner = whole.hqs.z0;
  fill_random(5, d_inner);
  Tensor nothing = whole.hqs.z0;
  nothing.set_zero();
  std::vector<float> gradient(parameters.size());
  add_gradient(whole, std::vector<Tensor>{d_inner, nothing}, gradient);
  std::vector<float> expected(fewer.size());
  add_gradient(shorter, std::span(&d_inner, 1), expected);
  for (std::size_t i = 0; i < 2 * of_one; ++i) {
    REQUIRE(gradient[i] == doctest::Approx(expected[i]).epsilon(1e-5).scale(1e-3));
  }
  CHECK(gradient[3 * of_one + 1] == doctest::Approx(expected[2 * of_one + 1]));
  for (std::size_t i = 2 * of_one; i < 3 * of_one; ++i) REQUIRE(gradient[i] == 0.0F);
}

TEST_CASE("a state of two layers has the same result as one of all") {
  for (const HqsPlan& plan : {filtered(small_du_or()), small_simple_du()}) {
    const std::vector<float> parameters = large_parameters(plan, 7);
    RangeImage other = measured_scene(plan);
    for (float& range : other.range_m) range *= 2.0F;  // leaves something in the state
    HqsRun run = run_of(plan, parameters, other);
    run.state = run.hqs.make_state(false);
    send(other, 1, run);
    send(measured_scene(plan), 1, run);
    REQUIRE(run.state.slots.size() == 2);
    CHECK(nn::same_bits(run.z(2), run_of(plan, parameters, measured_scene(plan)).z(2)));
  }
}

TEST_CASE("a small penalty keeps measured rows at L, a large one lets them go") {
  const HqsPlan plan = small_du_or();
  const RangeImage measured = measured_scene(plan);
  const auto distance_m = [&](float penalty) {
    std::vector<float> parameters = large_parameters(plan, 4);
    std::fill(parameters.end() - 3, parameters.end(), std::log(penalty));
    const HqsRun run = run_of(plan, parameters, measured);
    const std::vector<float> h = image_of(plan, run.layer(2).prior.h());
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
  const HqsPlan plan = small_du_or();
  const RangeImage measured = measured_scene(plan);
  const HqsRun run = run_of(plan, large_parameters(plan, 1), measured);
  const std::vector<float> z0 = image_of(plan, run.hqs.z0);
  const Candidates& candidates = run.hqs.measurement.candidates();
  CHECK(80.0 * z0[5 * 64 + 33] == doctest::Approx(0.5 * (measured.at(0, 33) + measured.at(1, 33))));
  CHECK(80.0 * z0[0 * 64 + 33] == doctest::Approx(measured.at(0, 33)));
  CHECK(80.0 * image_of(plan, candidates.above)[6 * 64 + 9] == doctest::Approx(measured.at(0, 9)));
  CHECK(80.0 * image_of(plan, candidates.below)[4 * 64 + 9] == doctest::Approx(measured.at(1, 9)));
  REQUIRE(run.hqs.measurement.l_row(3 * 4 + 1, 1) != nullptr);
  CHECK(80.0 * run.hqs.measurement.l_row(3 * 4 + 1, 1)[2] == doctest::Approx(measured.at(1, 9)));
  CHECK(run.hqs.measurement.l_row(2 * 4 + 1, 1) == nullptr);

  const HqsPlan simple = small_simple_du();
  const HqsRun of_simple = run_of(simple, large_parameters(simple, 1), measured);
  for (const float value : image_of(simple, of_simple.hqs.z0)) REQUIRE(value == 0.0F);
}

TEST_CASE(
    "the result does not change when min_pixels 0 switches a filter off that rejects nothing") {
  HqsPlan plan = small_du_or();
  const std::vector<float> parameters = large_parameters(plan, 6);
  const HqsRun off = run_of(plan, parameters, measured_scene(plan));
  plan.filter.min_pixels = 1;
  CHECK(same_bits(off, run_of(plan, parameters, measured_scene(plan))));
  for (const std::uint8_t rejected : off.layer(2).rejected) REQUIRE(rejected == 0);
}

TEST_CASE("columns and parameters that do not fit are refused") {
  const HqsPlan plan = small_du_or();
  const InstructionSet any = chosen_instruction_set();
  const auto message = [&](int columns) {
    return test::error_message([&] { make_network(plan, columns, any, 1); });
  };
  CHECK(message(32) == "no Error");
  CHECK(test::one_line_with(message(0), "0 columns", "1 to 64"));
  CHECK(test::one_line_with(message(128), "128 columns", "1 to 64"));
  CHECK(test::one_line_with(message(60), "60 columns", "multiple of 8"));
  const auto network = make_network(plan, 64, any, 1);
  std::vector<float> parameters = initial_parameters(plan, 1);
  parameters.pop_back();
  CHECK(test::refused_with([&] { network->set_parameters(parameters); },
                           std::to_string(parameters.size()),
                           std::to_string(parameters.size() + 1)));
}

}  // namespace hqslam::nn
