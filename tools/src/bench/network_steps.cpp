#include "bench/network_steps.h"

#include <fmt/format.h>

#include "hqslam/nn/hqs/two_modes.h"

namespace hqslam::tools {
namespace {

nn::ConvolutionShape shape(int input_channels, int output_channels, int kernel, int stride,
                           int padding) {
  return {input_channels, output_channels, kernel, kernel, stride, padding, padding};
}

/// nn/hqs/denoiser.h, UShapedDenoiserShape, says what they are.
std::vector<NetworkConvolution> u_shaped(const nn::NetworkDescription& description) {
  const nn::UShapedDenoiserShape& net = description.u_shaped;
  const int levels = static_cast<int>(net.channels.size());
  const int rows = description.sensor.rows() / net.tile.rows;
  const int columns = description.sensor.columns / net.tile.columns;
  const auto convolution = [&](std::string name, bool transposed, nn::ConvolutionShape kernel,
                               int from_level, int to_level) {
    return NetworkConvolution{std::move(name),
                              transposed,
                              kernel,
                              rows >> from_level,
                              columns >> from_level,
                              rows >> to_level,
                              columns >> to_level,
                              nn::ColumnPadding::kCircular};
  };
  std::vector<NetworkConvolution> result;
  result.push_back(convolution(
      "encoder.0", false, shape(net.tile.pixels() + net.memory, net.channels[0], 3, 1, 1), 0, 0));
  for (int level = 1; level < levels; ++level) {
    result.push_back(convolution(fmt::format("encoder.{}", level), false,
                                 shape(net.channels[level - 1], net.channels[level], 3, 2, 1),
                                 level - 1, level));
  }
  const int last = net.channels.back();
  result.push_back(
      convolution("bottleneck", false, shape(last, last, 3, 1, 1), levels - 1, levels - 1));
  for (int level = levels - 2; level >= 0; --level) {
    result.push_back(convolution(fmt::format("decoder.{}", level), true,
                                 shape(net.channels[level + 1], net.channels[level], 2, 2, 0),
                                 level + 1, level));
  }
  constexpr int kGroups = 5;  // four scores and a correction for each pixel
  result.push_back(
      convolution("head", false,
                  shape(net.channels[0], kGroups * net.tile.pixels() + net.memory, 1, 1, 0), 0, 0));
  return result;
}

/// nn/hqs/network_description.h, TwoModesLayerShape, says what they are. All layers, one after the
/// other: each has a shape of its own.
std::vector<NetworkConvolution> two_modes(const nn::NetworkDescription& description) {
  const nn::TwoModesShape& net = description.two_modes;
  const int rows = description.sensor.rows() / net.tile.rows;
  const int columns = description.sensor.columns / net.tile.columns;
  const int computed = net.tile.pixels() - net.tile.columns;
  const int seen = net.tile.pixels() + 2 * net.tile.columns;
  std::vector<NetworkConvolution> result;
  for (std::size_t k = 0; k < net.layers.size(); ++k) {
    const nn::TwoModesLayerShape& layer = net.layers[k];
    const auto add = [&](const std::string& name, bool transposed, nn::ConvolutionShape kernel,
                         int from_level, int to_level) {
      result.push_back({fmt::format("{}.{}", k, name), transposed, kernel, rows >> from_level,
                        columns >> from_level, rows >> to_level, columns >> to_level,
                        nn::ColumnPadding::kCircular});
    };
    const int inputs = k == 0 ? seen : seen + computed + net.memory;
    const int outputs =
        nn::kTwoModesOutputs * computed + (k + 1 < net.layers.size() ? net.memory : 0);
    const int lower = layer.lower_channels;
    add("encoder.0", false, shape(inputs, layer.channels, 3, 1, 1), 0, 0);
    add("encoder.1", false, shape(layer.channels, lower, 3, 2, 1), 0, 1);
    for (int block = 0; block <= layer.residual_blocks; ++block) {
      add(fmt::format("bottleneck.{}", block), false, shape(lower, lower, 3, 1, 1), 1, 1);
    }
    add("decoder.0", true, shape(lower, layer.channels, 2, 2, 0), 1, 0);
    add("head", false, shape(layer.channels, outputs, 1, 1, 0), 0, 0);
  }
  return result;
}

std::vector<NetworkConvolution> plain(const nn::NetworkDescription& description) {
  const nn::PlainDenoiserShape& net = description.plain;
  const int rows = description.sensor.rows();
  const int columns = description.sensor.columns;
  std::vector<NetworkConvolution> result;
  for (int i = 0; i < net.convolutions; ++i) {
    const int from = i == 0 ? 1 : net.features;
    const int to = i + 1 == net.convolutions ? 1 : net.features;
    result.push_back({fmt::format("convolution.{}", i), false, shape(from, to, 3, 1, 1), rows,
                      columns, rows, columns, nn::ColumnPadding::kZero});
  }
  return result;
}

}  // namespace

std::int64_t NetworkConvolution::multiply_adds() const {
  const std::int64_t pixels = transposed ? static_cast<std::int64_t>(input_rows) * input_columns
                                         : static_cast<std::int64_t>(output_rows) * output_columns;
  return shape.weights() * pixels;
}

std::vector<NetworkConvolution> convolutions_of(const nn::NetworkDescription& description) {
  switch (description.kind) {
    case nn::NetworkKind::kDuOr:
      return u_shaped(description);
    case nn::NetworkKind::kSimpleDu:
      return plain(description);
    case nn::NetworkKind::kDuMix:
      break;
  }
  return two_modes(description);
}

}  // namespace hqslam::tools
