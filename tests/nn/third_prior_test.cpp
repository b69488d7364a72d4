#include "hqs/hqs_architecture.h"
#include "hqslam/nn/network_json.h"
#include "small_training.h"

// A prior outside the library: all of it is here, with the table that names it.
namespace hqslam::nn {
namespace {

/// A kernel x kernel convolution from H to Z.
LayerGraph one_convolution_graph(int kernel, int rows, int columns, const Engine& engine) {
  LayerGraph graph({1, rows, columns}, engine);
  graph.add("convolution", {.kernel = {kernel, kernel}, .padding = {kernel / 2, kernel / 2}}, {0});
  return graph;
}

class OneConvolution final : public Prior, public PriorBackward {
 public:
  explicit OneConvolution(LayerGraph graph)
      : Prior(std::move(graph), {1, 1}), PriorBackward(static_cast<Prior&>(*this)) {}

  void forward(const Candidates&, PriorState& state, const PriorPass&) override {
    graph_.forward(state.values);
#pragma omp single
    state.z = state.output();
  }
  void backward(const Candidates&, const PriorState& state, PriorState& gradient,
                std::span<float> d_parameters) override {
    gradient.output() = gradient.z;
    gradient.output().fill_borders();
    graph_backward_.backward({&state.values, 1}, {&gradient.values, 1}, d_parameters);
  }
};

PriorDescription read_prior(JsonFields& sizes) {
  int kernel = 1;
  sizes.optional("kernel", kernel);
  return {.sizes = {{"kernel", kernel}},
          .graph =
              [kernel](int rows, int columns, const Engine& engine) {
                return one_convolution_graph(kernel, rows, columns, engine);
              },
          .make = [](LayerGraph graph, const NetworkDescription&, int,
                     const Engine&) { return std::make_unique<OneConvolution>(std::move(graph)); }};
}

std::shared_ptr<const Architecture> read(JsonFields& network) {
  return read_hqs({.kind = "one-convolution", .read_prior = read_prior}, network);
}

const Architectures kWithAThird{{"one-convolution", read}};

NetworkDescription network_with(const std::string& denoiser) {
  return network_from_json(
      R"({"kind": "one-convolution", "layers": 2, "measured_rows": 4, "denoiser": )" + denoiser +
          R"(, "sensor": )" + sensor_json(small_sensor()) + "}",
      "test", kWithAThird);
}

TrainingState trained_for(const NetworkDescription& description, int steps) {
  TrainingPlan plan;
  plan.steps = steps;
  plan.batch = 2;
  plan.learning_rate = 0.03F;
  plan.warm_up_steps = 1;
  Trainer trainer(description, plan, in_memory({{small_scene()}}), fresh_state(description), 2);
  const double before = trainer.step().loss;
  double after = before;
  for (int i = 1; i < steps; ++i) after = trainer.step().loss;
  CHECK(after < 0.5 * before);
  return trainer.state();
}

}  // namespace

TEST_CASE("a third prior is one file and one line: described, trained, written and read back") {
  const NetworkDescription description = network_with(R"({"kernel": 3})");
  const std::vector<ParameterShape> shapes = parameter_shapes(description);
  REQUIRE(shapes.size() == 2 * 2 + 1);
  CHECK(shapes[2].name == "layers.1.convolution.weight");
  CHECK(shapes[2].shape == std::vector<std::int64_t>{1, 1, 3, 3});
  CHECK(network_json(network_from_json(network_json(description), "again", kWithAThird)) ==
        network_json(description));

  const Weights weights = weights_with(description, trained_for(description, 40).parameters);
  const TemporaryDirectory directory;
  const std::string path = directory.file("weights.npz");
  write_weights(path, weights);
  const Weights read = read_weights(path, kWithAThird);
  CHECK(read.parameters == weights.parameters);
  CHECK_NOTHROW(check_self_test(read, path));
}

}  // namespace hqslam::nn
