#pragma once

#include "hqs/hqs_backward.h"
#include "hqs/plain_prior.h"
#include "hqs/two_modes_prior.h"
#include "hqslam/nn/training/trainable_network.h"
#include "hqslam/nn/weights_file.h"
#include "made_images.h"
#include "random_values.h"

// Networks of a few thousand parameters on images of 16 x 64 pixels; tools/make_golden.py has the
// same sensor and scene.
namespace hqslam::nn {

inline SensorModel small_sensor() {
  SensorModel sensor = test::even_sensor(16, 64, 6.0, 1.5);
  sensor.name = "small";
  return sensor;
}

/// Walls round about, a box and poles in front of them, and no return in one corner.
inline RangeImage small_scene() {
  return test::made_image(16, 64, [](int row, int column) {
    const double azimuth_rad = 2.0 * std::numbers::pi * column / 64;
    double range_m = 12.0 + 4.0 * std::sin(azimuth_rad) - 0.25 * row;
    if (row >= 5 && column >= 20 && column < 31) range_m = 5.0;
    for (const int pole : {6, 13, 37, 60}) range_m = column == pole ? 3.0 : range_m;
    if (row < 8 && column >= 44 && column < 51) range_m = 0.0;
    return range_m;
  });
}

/// A network of eq. 10 as a test likes it: a preset, and the sizes of its prior.
struct HqsPlan : HqsSizes {
  HqsPreset preset = kDuOr;
  UShapedPriorShape u_shaped;  ///< of DU-OR
  PlainPriorShape plain;       ///< of Simple DU
  SensorModel sensor = small_sensor();
  RowSelection measured_rows{3, 4};
  float range_scale_m = 80.0F;

  bool simple() const { return preset.learns_alpha; }
  int penalties() const { return fixed_penalty ? 0 : simple() || shared ? 1 : layers; }
  TileSize tile() const { return simple() ? TileSize{} : u_shaped.tile; }
  operator NetworkDescription() const {  // NOLINT: what a plan is for
    NetworkDescription d;
    d.architecture = std::make_shared<HqsArchitecture>(
        preset, *this, simple() ? plain_prior(plain) : u_shaped_prior(u_shaped));
    d.sensor = sensor;
    d.measured_rows = measured_rows;
    d.range_scale_m = range_scale_m;
    return d;
  }
};

/// No filter inside.
inline HqsPlan small_du_or() {
  HqsPlan plan;
  plan.layers = 3;
  plan.u_shaped = {.tile = {4, 4}, .channels = {6, 8}, .memory = 3, .negative_slope = 0.0F};
  plan.filter.min_pixels = 0;
  return plan;
}

inline HqsPlan small_simple_du() {
  HqsPlan plan;
  plan.preset = kSimpleDu;
  plan.layers = 3;
  plan.plain = {.features = 8, .convolutions = 5, .dropout = 0.0F};
  plan.filter.min_pixels = 0;
  return plan;
}

inline TwoModesShape small_two_modes() {
  return {.tile = {4, 4},
          .channels = 6,
          .lower_channels = 8,
          .residual_blocks = 1,
          .negative_slope = 0.125F,
          .memory = 0};
}

/// On the images of small_du_or.
inline NetworkDescription small_network(std::shared_ptr<const Architecture> architecture) {
  NetworkDescription description = small_du_or();
  description.architecture = std::move(architecture);
  return description;
}

inline NetworkDescription small_du_mix(const TwoModesShape& shape = small_two_modes()) {
  HqsSizes sizes;
  sizes.layers = 1;
  sizes.last_filter.min_pixels = 0;
  return small_network(std::make_shared<HqsArchitecture>(kDuMix, sizes, two_modes_prior(shape)));
}

/// For any beams, with an uneven table and other rows than the tests' usual ones.
inline NetworkDescription small_any_beams(RowSelection rows, bool scan_memory = false) {
  TwoModesShape shape = small_two_modes();
  shape.any_beams = true;
  shape.scan_memory = scan_memory;
  SensorModel sensor = small_du_or().sensor;
  for (std::size_t row = 0; row < sensor.beam_elevation_rad.size(); ++row) {
    const auto place = static_cast<double>(row);
    sensor.beam_elevation_rad[row] = 0.1 - 0.006 * place - 0.0007 * place * place;
  }
  return for_sensor(small_du_mix(shape), sensor, rows);
}

/// DU-Mix with what earlier scans measured (Observation::recalled).
inline NetworkDescription small_du_mix_with_memory() {
  TwoModesShape shape = small_two_modes();
  shape.scan_memory = true;
  return small_du_mix(shape);
}

/// Most pixels of the scene, some of them off, with weights of all sizes.
inline RecalledImage recalled_scene() {
  RecalledImage recalled{small_scene(), std::vector<float>(16 * 64)};
  const std::vector<float> random = random_values(5, 2 * 16 * 64);
  for (std::size_t i = 0; i < recalled.weight.size(); ++i) {
    const bool there = random[i] > -0.4F && recalled.image.range_m[i] > 0.0F;
    recalled.image.range_m[i] *= there ? 1.0F + 0.1F * random[i] : 0.0F;
    recalled.weight[i] = there ? 4.0F * std::fabs(random[i + 16 * 64]) : 0.0F;
  }
  return recalled;
}

inline std::vector<float> large_start(const NetworkDescription& description) {
  std::vector<float> parameters = initial_parameters(description, 4);
  const std::vector<float> noise = random_values(5, static_cast<int>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i] += 0.1F * noise[i];
  return parameters;
}

/// An image in units of range_scale_m.
inline std::vector<float> image_of(const HqsPlan& plan, const Tensor& tiles) {
  const TileSize tile = plan.tile();
  std::vector<float> image(tile.pixels() * tiles.rows() * tiles.columns());
  from_tiles(tiles, tile, image.data());
  return image;
}

/// A network and what one scan left in it.
struct HqsRun {
  Hqs hqs;
  HqsState state;
  std::vector<float> parameters = {};

  const HqsLayer& layer(int k) const { return state.layer(k); }
  const Tensor& z(int k) const { return state.layer(k).prior.z; }
};

/// Sends a scan through the loop.
inline void send(const RangeImage& measured, int threads, HqsRun& run) {
#pragma omp parallel num_threads(threads)
  hqs_loop(run.hqs, measured, run.state, {});
}

inline HqsRun run_of(const NetworkDescription& description, const std::vector<float>& parameters,
                     const RangeImage& measured,
                     InstructionSet instruction_set = chosen_instruction_set(), int threads = 1) {
  HqsRun run{Hqs(description, measured.columns, {instruction_set, threads}), {}, parameters};
  run.hqs.set_parameters(parameters);
  run.state = run.hqs.make_state(true);
  run.state.last_y = true;
  send(measured, threads, run);
  return run;
}

/// Backward with the given d loss / d Z of the last d_z.size() layers; the loss does not depend on
/// the others.
inline void add_gradient(HqsRun& run, std::span<const Tensor> d_z, std::span<float> d_parameters) {
  HqsGradient gradient(run.hqs);
  gradient.take_parameters(run.parameters);
  const LayerLoss loss = [&](int k, const PriorState&, PriorState& of_layer) {
    const int i = k - (run.hqs.layers - static_cast<int>(d_z.size()));
    if (i >= 0) {
      of_layer.z = d_z[i];
    } else {
      of_layer.z.set_zero();
    }
    return 0.0;
  };
  hqs_backward(run.hqs, run.state, loss, gradient, d_parameters);
}

/// TrainableNetwork::add_gradients of one scan.
inline double add_gradient(TrainableNetwork& network, const TrainingSample& sample,
                           std::span<float> d_parameters, std::uint64_t seed = 0) {
  return network.add_gradients({&sample, 1}, {}, {&seed, 1}, d_parameters);
}

/// The measured rows of the scene.
inline RangeImage measured_scene(const NetworkDescription& description) {
  return select_rows(small_scene(), description.measured_rows);
}

/// Larger than the starting values, but for penalties, so that every part of the network matters.
inline std::vector<float> large_parameters(const NetworkDescription& network, std::uint32_t seed) {
  std::vector<float> parameters = initial_parameters(network, seed);
  const ParameterShape last = parameter_shapes(network).back();
  const bool penalties = last.name == "log_penalty" || last.name == "alpha";
  const std::int64_t count = std::ssize(parameters) - (penalties ? last.elements() : 0);
  const std::vector<float> random = random_values(seed, std::ssize(parameters));
  for (std::int64_t i = 0; i < count; ++i) parameters[i] = 0.3F * random[i];
  return parameters;
}

/// A network with these parameters.
inline std::unique_ptr<Network> made(const NetworkDescription& description,
                                     const std::vector<float>& parameters, int threads = 1,
                                     InstructionSet instruction_set = chosen_instruction_set(),
                                     int columns = 64) {
  auto network = make_network(description, columns, instruction_set, threads);
  network->set_parameters(parameters);
  return network;
}

/// One that is trained.
inline std::unique_ptr<TrainableNetwork> trainable(
    const NetworkDescription& description, const std::vector<float>& parameters,
    InstructionSet instruction_set = chosen_instruction_set(), int columns = 64) {
  auto network = make_trainable(description, columns, instruction_set);
  network->set_parameters(parameters);
  return network;
}

/// A whole weights file.
inline Weights weights_with(const NetworkDescription& description,
                            const std::vector<float>& parameters) {
  return {description, parameters, "{}",
          make_self_test(*made(description, parameters), measured_scene(description))};
}
inline Weights small_weights(const NetworkDescription& description, std::uint64_t seed = 3) {
  Weights weights = weights_with(description, initial_parameters(description, seed));
  weights.training = R"({"seed": )" + std::to_string(seed) + "}";
  return weights;
}

/// check_self_test of a network with the weights.
inline void check_self_test(const Weights& weights, const std::string& path) {
  check_self_test(*made(weights.description, weights.parameters, 1, chosen_instruction_set(),
                        weights.description.sensor.columns),
                  weights.description, weights.self_test, path);
}

}  // namespace hqslam::nn
