#include "srae.h"

#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "parameters.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
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

/// Nothing goes round: the paper's convolutions see zeros beyond the edges.
LayerGraph Srae::graph(const NetworkDescription& d, int columns, Purpose purpose,
                       const Engine& engine) const {
  const int upscaling = d.measured_rows.stride;
  return srae_graph(shape_, {1, d.sensor.rows() / upscaling, columns, ColumnPadding::kZero},
                    upscaling, purpose, engine);
}

}  // namespace hqslam::nn
