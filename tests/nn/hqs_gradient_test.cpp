#include "golden.h"
#include "hqslam/nn/reference/reference.h"
#include "small_network.h"

// The networks against the reference, which shares no line with them: values and gradients.
namespace hqslam::nn {
namespace {

struct GradientProblem {
  HqsPlan plan;
  RangeImage measured;
  std::vector<float> parameters;
  /// loss = sum of direction times Z over the last layers, rows x columns each.
  std::vector<std::vector<float>> directions;
};

GradientProblem problem(const HqsPlan& plan, int columns, std::uint32_t seed, int layers_in_loss) {
  GradientProblem p{plan, RangeImage(4, columns), large_parameters(plan, seed), {}};
  for (int i = 0; i < layers_in_loss; ++i) {
    p.directions.push_back(random_values(seed + 1 + i, 16 * columns));
  }
  const RangeImage scene = measured_scene(plan);
  p.measured = made_image(4, columns, [&](int row, int column) { return scene.at(row, column); });
  if (plan.penalties() == 1) p.parameters.back() = 0.4F;  // at 10.99 hardly anything flows
  return p;
}

using Masks = std::vector<std::vector<std::uint8_t>>;

struct EngineResult {
  std::vector<std::vector<float>> z;  ///< of each layer, units of range_scale_m
  std::vector<float> gradient;
  Masks rejected;
};

EngineResult engine(const GradientProblem& p) {
  HqsRun run = run_of(p.plan, p.parameters, p.measured);
  std::vector<Tensor> d_z(p.directions.size(), run.hqs.z0);
  for (std::size_t i = 0; i < d_z.size(); ++i) {
    to_tiles(p.directions[i].data(), p.plan.tile(), d_z[i]);
  }
  EngineResult result{{}, std::vector<float>(p.parameters.size()), {}};
  add_gradient(run, d_z, result.gradient);
  for (const HqsLayer& layer : run.state.slots) {
    result.z.push_back(image_of(p.plan, layer.prior.z));
    result.rejected.push_back(layer.rejected);
  }
  return result;
}

/// Z of each layer, in units of range_scale_m.
std::vector<std::vector<double>> reference_z(const GradientProblem& p,
                                             const std::vector<double>& parameters,
                                             const Masks& rejected) {
  const auto trace = reference_trace(p.plan, parameters, p.measured, {.rejected = rejected});
  std::vector<std::vector<double>> z;
  for (int k = 0; k < p.plan.layers; ++k) {
    const auto z_of_layer = trace.tensor("layers." + std::to_string(k) + ".z").all();
    z.emplace_back(z_of_layer.begin(), z_of_layer.end());
    for (double& range : z.back()) range /= static_cast<double>(p.plan.range_scale_m);
  }
  return z;
}

double loss(const GradientProblem& p, const std::vector<double>& parameters,
            const Masks& rejected) {
  const auto z = reference_z(p, parameters, rejected);
  double sum = 0.0;
  for (std::size_t n = 0; n < p.directions.size(); ++n) {
    const std::vector<double>& of_layer = z[z.size() - p.directions.size() + n];
    for (std::size_t i = 0; i < of_layer.size(); ++i) sum += of_layer[i] * p.directions[n][i];
  }
  return sum;
}

/// Central differences at `each` parameters of every array.
void check_gradients(const GradientProblem& p, int each, const EngineResult& result) {
  std::vector<double> parameters(p.parameters.begin(), p.parameters.end());
  std::mt19937 generator(99);
  std::size_t first = 0;
  int checked = 0;
  int wrong = 0;
  for (const ParameterShape& shape : parameter_shapes(p.plan)) {
    CAPTURE(shape.name);
    const auto count = static_cast<std::size_t>(shape.elements());
    double largest = 0.0;
    for (std::size_t i = first; i < first + count; ++i) {
      largest = std::max(largest, std::fabs(static_cast<double>(result.gradient[i])));
    }
    REQUIRE(largest > 0.0);
    for (int n = 0; n < each; ++n) {
      const std::size_t i =
          first + (count <= static_cast<std::size_t>(each) ? static_cast<std::size_t>(n) % count
                                                           : generator() % count);
      const double expected =
          slope_of([&] { return loss(p, parameters, result.rejected); }, 1e-6, parameters[i]);
      ++checked;
      wrong += !(std::fabs(result.gradient[i] - expected) < 1e-4 * largest);
      // Even where an activation changes sides on the way the two cannot be far apart.
      CHECK(std::fabs(result.gradient[i] - expected) < 0.02 * largest);
    }
    first += count;
  }
  CHECK(first == p.parameters.size());
  CAPTURE(checked);
  CHECK(wrong <= checked / 50);
}

void check_network(const GradientProblem& p, int each) {
  const std::vector<double> parameters(p.parameters.begin(), p.parameters.end());
  const EngineResult found = engine(p);
  const auto expected = reference_z(p, parameters, found.rejected);
  for (std::size_t layer = 0; layer < expected.size(); ++layer) {
    CHECK(relative_error(found.z[layer], expected[layer]) < 1e-4);
  }
  check_gradients(p, each, found);
}

}  // namespace

// With a loss on the last layer alone the networks are held against PyTorch in hqs_loop_test.cpp.
TEST_CASE("DU-OR, Simple DU and their gradients equal the reference, with losses of layers") {
  HqsPlan three_levels = small_du_or();  // with other tiles
  three_levels.layers = 2;
  three_levels.u_shaped = {
      .tile = {2, 4}, .channels = {5, 3, 4}, .memory = 2, .negative_slope = 0.2F};
  check_network(problem(three_levels, 32, 22, 2), 4);
  HqsPlan without_memory = small_du_or();
  without_memory.u_shaped.memory = 0;
  check_network(problem(without_memory, 32, 23, 3), 4);
  HqsPlan filtered = small_du_or();
  filtered.filter.min_pixels = 12;
  check_network(problem(filtered, 32, 24, 3), 2);
  check_network(problem(small_simple_du(), 32, 26, 3), 3);
}

TEST_CASE("the same holds for every choice that a recipe has of the loop") {
  HqsPlan of_h = small_du_or();
  of_h.filter.min_pixels = 12;
  of_h.u_shaped.neighbours_of_h = true;
  check_network(problem(of_h, 32, 27, 3), 2);
  HqsPlan zero = of_h;
  zero.rejected_pixel = RejectedPixel::kZero;
  zero.shared = true;
  check_network(problem(zero, 32, 28, 3), 2);
  HqsPlan of_z = of_h;
  of_z.filtered_iterate = FilteredIterate::kZ;
  of_z.fixed_penalty = 0.3F;
  check_network(problem(of_z, 32, 29, 3), 2);
  of_z.rejected_pixel = RejectedPixel::kZero;
  check_network(problem(of_z, 32, 30, 3), 2);
  of_z.filter.min_pixels = 0;  // Y = Z
  check_network(problem(of_z, 32, 31, 2), 2);
}

TEST_CASE("with neighbours from H penalties, except the first (Z and Y are L), have gradients") {
  HqsPlan plan = small_du_or();
  plan.u_shaped.neighbours_of_h = true;
  const EngineResult result = engine(problem(plan, 64, 32, 3));
  const auto penalties = std::span(result.gradient).last(3);
  CHECK(penalties[0] == 0.0F);
  CHECK(penalties[1] != 0.0F);
  CHECK(penalties[2] != 0.0F);
}

}  // namespace hqslam::nn
