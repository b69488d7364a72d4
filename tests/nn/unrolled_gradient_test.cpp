#include <algorithm>
#include <random>

#include "double_network.h"
#include "golden.h"
#include "random_values.h"
#include "small_network.h"

// The engine against a second network in double precision, which shares no line with it.
namespace hqslam::nn {
namespace {

struct Problem {
  NetworkDescription description;
  RangeImage measured;
  std::vector<float> parameters;
  std::vector<float> direction;  ///< loss = sum of direction times Z, rows x columns
};

Problem problem(const NetworkDescription& description, int columns, std::uint32_t seed) {
  Problem p{description, RangeImage(4, columns), initial_parameters(description, seed),
            random_values(seed + 1, 16 * columns)};
  const RangeImage scene = select_rows(small_scene(), description.measured_rows);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < columns; ++column) {
      p.measured.at(row, column) = scene.at(row, column);
    }
  }
  const auto random = random_values(seed, static_cast<std::int64_t>(p.parameters.size()));
  const int penalties = description.kind == NetworkKind::kDuOr ? description.layers : 1;
  for (std::size_t i = 0; i + penalties < p.parameters.size(); ++i) {
    p.parameters[i] = 0.3F * random[i];
  }
  if (penalties == 1) p.parameters.back() = 0.4F;  // at 10.99 hardly anything flows
  return p;
}

struct EngineResult {
  std::vector<float> z;
  std::vector<float> gradient;
  plain::Masks rejected;
};

EngineResult engine(const Problem& p, InstructionSet instruction_set) {
  UnrolledNetwork network(p.description, p.measured.columns, instruction_set, 1);
  network.set_parameters(p.parameters);
  UnrolledState state = network.make_state();
  network.start(p.measured, state);
  network.forward(state);
  network.finish_last_layer(state);
  Tensor d_z = state.z0;
  to_tiles(p.direction.data(), tile_of(p.description), d_z);
  EngineResult result{image_of(p.description, state.slots.back().denoiser.z),
                      std::vector<float>(p.parameters.size()),
                      {}};
  network.backward(state, std::span(&d_z, 1), result.gradient);
  for (const LayerState& layer : state.slots) result.rejected.push_back(layer.rejected);
  return result;
}

double loss(const Problem& p, const std::vector<double>& parameters, const plain::Masks& rejected) {
  const std::vector<double> z = plain::last_z(p.description, parameters, p.measured, rejected);
  double sum = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) sum += z[i] * p.direction[i];
  return sum;
}

/// Central differences at `each` parameters of every array.
void check_gradients(const Problem& p, int each, const EngineResult& result) {
  std::vector<double> parameters(p.parameters.begin(), p.parameters.end());
  std::mt19937 generator(99);
  std::size_t first = 0;
  int checked = 0;
  int wrong = 0;
  for (const ParameterShape& shape : parameter_shapes(p.description)) {
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
      constexpr double kStep = 1e-6;
      const double middle = parameters[i];
      parameters[i] = middle + kStep;
      const double above = loss(p, parameters, result.rejected);
      parameters[i] = middle - kStep;
      const double below = loss(p, parameters, result.rejected);
      parameters[i] = middle;
      const double expected = (above - below) / (2.0 * kStep);
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

void check_network(const Problem& p, int each) {
  const std::vector<double> parameters(p.parameters.begin(), p.parameters.end());
  for (const InstructionSet any : available_instruction_sets()) {
    CAPTURE(name(any));
    const EngineResult result = engine(p, any);
    const std::vector<double> expected =
        plain::last_z(p.description, parameters, p.measured, result.rejected);
    CHECK(relative_error(result.z, expected) < 1e-4);
    if (any == chosen_instruction_set()) check_gradients(p, each, result);
  }
}

}  // namespace

TEST_CASE("DU-OR and its gradients equal a naive network in double precision") {
  check_network(problem(small_du_or(), 64, 21), 4);
}

TEST_CASE("the same holds for cut-outs, three levels, other tiles, and leaky activations") {
  NetworkDescription d = small_du_or();
  d.layers = 2;
  d.u_shaped = {.tile = {2, 4}, .channels = {5, 3, 4}, .memory = 2, .negative_slope = 0.2F};
  check_network(problem(d, 32, 22), 4);
}

TEST_CASE("the same holds without memory and with shared weights") {
  NetworkDescription d = small_du_or();
  d.shared_weights = true;
  d.u_shaped.memory = 0;
  check_network(problem(d, 32, 23), 4);
}

TEST_CASE("the same holds for every way to use what the filter rejects") {
  for (const FilteredIterate iterate : {FilteredIterate::kH, FilteredIterate::kZ}) {
    for (const RejectedPixel pixel : {RejectedPixel::kTakesZ, RejectedPixel::kZero}) {
      NetworkDescription d = small_du_or();
      d.filter.min_pixels = 12;
      d.filtered = iterate;
      d.rejected = pixel;
      CAPTURE(static_cast<int>(iterate));
      CAPTURE(static_cast<int>(pixel));
      check_network(problem(d, 32, 24), 2);
    }
  }
}

TEST_CASE("Simple DU and its gradients equal a naive network in double precision") {
  check_network(problem(small_simple_du(), 32, 25), 6);
}

TEST_CASE("Simple DU with weights of its own in each layer too") {
  NetworkDescription d = small_simple_du();
  d.shared_weights = false;
  check_network(problem(d, 32, 26), 3);
}

}  // namespace hqslam::nn
