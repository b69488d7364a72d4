#include "srae.h"

#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "parameters.h"
#include "direct_network.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

/// The measured rows. Nothing goes round: the paper's convolutions see zeros beyond the edges.
TensorShape input_of(const NetworkDescription& d, int columns) {
  return {1, d.sensor.rows() / d.measured_rows.stride, columns, ColumnPadding::kZero};
}

}  // namespace

Srae::Srae(const SraeShape& shape) : shape_(shape) {
  constexpr int kMostFilters = 128;
  constexpr int kMostPasses = 1000;
  check_field("filters", shape.filters, 1, kMostFilters);
  check_field("passes", shape.passes, 1, kMostPasses);
  if (!(shape.dropout >= 0.0F && shape.dropout < 1.0F)) {
    throw Error(fmt::format("network: dropout is {}, expected 0 to below 1", shape.dropout));
  }
  if (!(shape.largest_deviation >= 0.0F)) {
    throw Error(fmt::format("network: largest_deviation is {}, expected at least 0",
                            shape.largest_deviation));
  }
}

void Srae::write(nlohmann::ordered_json& network) const {
  network["filters"] = shape_.filters;
  network["dropout"] = shape_.dropout;
  network["passes"] = shape_.passes;
  network["largest_deviation"] = shape_.largest_deviation;
}

std::shared_ptr<const Architecture> read_srae(JsonFields& network) {
  SraeShape shape;
  network.optional("filters", shape.filters);
  network.optional("dropout", shape.dropout);
  network.optional("passes", shape.passes);
  network.optional("largest_deviation", shape.largest_deviation);
  return std::make_shared<Srae>(shape);
}

void Srae::validate(const NetworkDescription& d) const {
  const int rows = d.sensor.rows();
  const int stride = d.measured_rows.stride;
  if (!std::has_single_bit(static_cast<unsigned>(stride)) || rows % stride != 0 ||
      d.measured_rows.offset >= stride || rows % kSraeStride != 0) {
    throw Error(fmt::format(
        "network: measured rows {} + n {} of {}, expected one in each 2, 4, 8, ... rows and a "
        "multiple of {} rows in all",
        d.measured_rows.offset, stride, rows, kSraeStride));
  }
  constexpr std::int64_t kTensorsOfFilters = 40;  // with gradients, of the whole image's size
  check_memory(kTensorsOfFilters * shape_.filters * rows * d.sensor.columns, d);
}

LayerGraph Srae::training_graph(const NetworkDescription& d, int columns) const {
  return srae_graph(shape_, input_of(d, columns), d.measured_rows.stride, Purpose::kTraining, {});
}

std::vector<ParameterShape> Srae::parameter_shapes(const NetworkDescription& d) const {
  return training_graph(d, kSraeStride).parameter_shapes();
}

std::vector<float> Srae::initial_parameters(const NetworkDescription& d, std::uint64_t seed) const {
  return training_graph(d, kSraeStride).initial_parameters(seed);
}

std::unique_ptr<Network> Srae::make_network(const NetworkDescription& d, int columns,
                                            InstructionSet instruction_set, int threads) const {
  const TensorShape input = input_of(d, columns);
  const int upscaling = d.measured_rows.stride;
  LayerGraph lifting =
      srae_graph(shape_, input, upscaling, Purpose::kLifting, {instruction_set, threads});
  DirectPlan plan{
      .graph_for_training =
          [shape = shape_, input, upscaling, instruction_set] {
            return srae_graph(shape, input, upscaling, Purpose::kTraining, {instruction_set, 1});
          },
      .passes = shape_.passes,
      .largest_deviation = shape_.largest_deviation};
  return std::make_unique<DirectNetwork>(std::move(lifting), std::move(plan), d, threads);
}

}  // namespace hqslam::nn
