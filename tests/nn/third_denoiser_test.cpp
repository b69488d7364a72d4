#include <doctest/doctest.h>

#include <memory>

#include "convolution_graph.h"
#include "error_message.h"
#include "hqs/denoiser.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/training/trainer.h"
#include "hqslam/nn/weights_file.h"
#include "small_training.h"
#include "temporary_directory.h"

// A denoiser that the library does not know: all there is of it stands here.
namespace hqslam::nn {
namespace {

constexpr const char* kKind = "one-convolution";

/// A kernel x kernel convolution from the image to Z.
class OneConvolution final : public Denoiser {
 public:
  OneConvolution(int kernel, int rows, int columns, InstructionSet instruction_set, int threads)
      : graph_({{.name = "convolution", .kernel = kernel}}, {1, 1}, rows, columns, instruction_set,
               threads) {}

  TileSize tile() const override { return {}; }
  ColumnPadding padding() const override { return ColumnPadding::kCircular; }
  int memory_channels() const override { return 0; }
  std::vector<ParameterShape> parameter_shapes() const override {
    return graph_.parameter_shapes();
  }
  std::vector<float> initial_parameters(std::uint64_t seed) const override {
    return graph_.initial_parameters(seed);
  }
  std::int64_t multiply_adds() const override { return graph_.multiply_adds(); }
  DenoiserState make_state(bool) const override {
    return {graph_.make_values(), graph_.make_values().back()};
  }
  void set_parameters(std::span<const float> parameters) override {
    graph_.set_parameters(parameters);
  }
  void forward(const Candidates&, DenoiserState& state, std::optional<std::uint64_t>) override {
    graph_.forward(state.values);
#pragma omp single
    state.z = state.output();
  }
  void backward(const Candidates&, const DenoiserState& state, DenoiserState& gradient,
                std::span<float> d_parameters) override {
    gradient.output() = gradient.z;
    gradient.output().fill_borders();
    graph_.backward(state.values, gradient.values, d_parameters);
  }

 private:
  ConvolutionGraph graph_;
};

DenoiserDescription one_convolution(JsonFields& sizes) {
  int kernel = 1;
  sizes.optional("kernel", kernel);
  return {kKind, {{"kernel", kernel}}, {1, 1}, [kernel](int rows, int columns, auto... how) {
            return std::make_unique<OneConvolution>(kernel, rows, columns, how...);
          }};
}

NetworkDescription network_with(const std::string& denoiser) {
  static const bool added = [] {
    add_denoiser({kKind, one_convolution});
    return true;
  }();
  REQUIRE(added);
  return network_from_json(R"({"kind": "du-or", "layers": 2, "measured_rows": 4, "denoiser": )" +
                               denoiser + R"(, "sensor": )" + sensor_json(small_sensor()) + "}",
                           "test");
}

TrainingState trained(const NetworkDescription& description, int steps) {
  std::vector<float> start = initial_parameters(description, 1);
  TrainingPlan plan;
  plan.steps = steps;
  plan.batch = 2;
  plan.learning_rate = 0.03F;
  plan.warm_up_steps = 1;
  Trainer trainer(description, plan, in_memory({small_scene()}),
                  {start, AdamW({}, start.size()), start}, 2, alone());
  const double before = trainer.step().loss;
  double after = before;
  for (int i = 1; i < steps; ++i) after = trainer.step().loss;
  CHECK(after < 0.5 * before);
  return trainer.state();
}

}  // namespace

TEST_CASE("a third denoiser is one file: it is described, trained, written and read back") {
  const NetworkDescription description =
      network_with(R"({"kind": "one-convolution", "kernel": 3})");
  const std::vector<ParameterShape> shapes = parameter_shapes(description);
  REQUIRE(shapes.size() == 2 * 2 + 1);
  CHECK(shapes[2].name == "layers.1.convolution.weight");
  CHECK(shapes[2].shape == std::vector<std::int64_t>{1, 1, 3, 3});
  CHECK(network_json(network_from_json(network_json(description), "again")) ==
        network_json(description));

  Weights weights;
  weights.description = description;
  weights.parameters = trained(description, 40).parameters;
  weights.training = "{}";
  weights.self_test = make_self_test(description, weights.parameters,
                                     select_rows(small_scene(), description.measured_rows));
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("weights.npz");
  write_weights(path, weights);
  const Weights read = read_weights(path);
  CHECK(read.parameters == weights.parameters);
  CHECK_NOTHROW(check_self_test(read, path));
}

TEST_CASE("the sizes of a third denoiser are checked as those of the others are") {
  const auto message = [](const std::string& denoiser) {
    return test::error_message([&] { network_with(denoiser); });
  };
  CHECK(message(R"({"kind": "one-convolution"})") == "no Error");
  CHECK(test::one_line_with(message(R"({"kind": "one-convolution", "features": 3})"),
                            "test: denoiser", "unknown field 'features'"));
  CHECK(test::one_line_with(message(R"({"kind": "two-convolutions"})"), "kind",
                            "u-shaped, plain, one-convolution", "two-convolutions"));
}

}  // namespace hqslam::nn
