#include "tulip.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hqslam/core/error.h"
#include "layers/layers.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

constexpr float kHeadSlope = 0.01F;

/// Uniform starting values with this standard deviation.
float limit_of(float deviation) { return std::numbers::sqrt3_v<float> * deviation; }
/// PyTorch's start of a convolution.
float limit_of_taps(int taps) {
  return limit_of(std::sqrt(1.0F / (3.0F * static_cast<float>(taps))));
}

/// Adds layers to a graph; every function returns the number of its result.
struct TulipBuilder {
  const TulipShape& shape;
  LayerGraph graph;

  int channels(int from) const { return graph.shape(from).channels; }

  int norm(const std::string& name, int from) {
    return graph.add(name, make_layer_norm(graph.shape(from)), {from});
  }

  /// inputs: one, and what is added.
  int linear(const std::string& name, int outputs, std::vector<int> inputs, bool bias = true) {
    constexpr float kDeviation = 0.02F;
    return graph.add(
        name,
        {.channels = outputs, .bias = bias, .linear = true, .start_limit = limit_of(kDeviation)},
        std::move(inputs));
  }

  int block(const std::string& name, int heads, bool shifted, int x) {
    const int c = channels(x);
    const int qkv = linear(name + ".attn.qkv", 3 * c, {norm(name + ".norm1", x)});
    const int attended =
        graph.add(name + ".attn",
                  make_window_attention(
                      {.heads = heads, .shifted = shifted, .circular = shape.circular_attention},
                      graph.shape(qkv), graph.engine()),
                  {qkv});
    x = linear(name + ".attn.proj", c, {attended, x});
    const int hidden = linear(name + ".mlp.fc1", 4 * c, {norm(name + ".norm2", x)});
    const int activated =
        graph.add("gelu", make_gelu(graph.shape(hidden), graph.engine()), {hidden});
    return linear(name + ".mlp.fc2", c, {activated, x});
  }

  int two_blocks(const std::string& name, int heads, int x) {
    x = block(name + ".blocks.0", heads, false, x);
    return block(name + ".blocks.1", heads, true, x);
  }

  int downsample(const std::string& name, int x) {
    const int merged = graph.add("merging", make_patch_merging(graph.shape(x)), {x});
    return linear(name + ".reduction", 2 * channels(x), {norm(name + ".norm", merged)}, false);
  }

  int shuffled(const std::string& name, int outputs, float slope, int factor, int x) {
    const int expanded = graph.add(
        name,
        {.channels = outputs, .negative_slope = slope, .start_limit = limit_of_taps(channels(x))},
        {x});
    return graph.add("shuffle", make_pixel_shuffle(factor, graph.shape(expanded)), {expanded});
  }

  int upsample(const std::string& name, int x) {
    return shuffled(name + ".expand", 2 * channels(x), 1.0F, 2, x);
  }
};

}  // namespace

Tulip::Tulip(TulipShape shape) : shape_(std::move(shape)) {
  constexpr int kMostChannels = 256;
  constexpr int kMostStages = 5;
  constexpr int kGreatestDepth = 64;
  check_field("channels", shape_.channels, 1, kMostChannels);
  check_field("number of heads", static_cast<int>(shape_.heads.size()), 2, kMostStages);
  for (std::size_t stage = 0; stage < shape_.heads.size(); ++stage) {
    const int channels = shape_.channels << stage;
    const int heads = shape_.heads[stage];
    check_field("heads", heads, 1, kMostChannels);
    if (channels % (4 * heads) != 0 || channels / heads > kGreatestDepth) {
      throw Error("network: {} heads for {} channels, expected 4, 8, ... {} channels for each",
                  heads, channels, kGreatestDepth);
    }
  }
}

void Tulip::write(nlohmann::ordered_json& network) const {
  network["channels"] = shape_.channels;
  network["heads"] = shape_.heads;
  network["circular_attention"] = shape_.circular_attention;
}

std::shared_ptr<const Architecture> read_tulip(JsonFields& network) {
  TulipShape shape;
  network.optional("channels", shape.channels);
  if (network.has("heads")) shape.heads = network.integers("heads");
  network.optional("circular_attention", shape.circular_attention);
  return std::make_shared<Tulip>(std::move(shape));
}

int Tulip::column_multiple() const {
  return (kTulipUpscaling * kWindowColumns) << (shape_.heads.size() - 1);
}

void Tulip::validate(const NetworkDescription& d) const {
  const int rows = d.sensor.rows();
  const int multiple = (kTulipUpscaling * kWindowRows) << (shape_.heads.size() - 1);
  if (d.measured_rows.stride != kTulipUpscaling || d.measured_rows.offset >= kTulipUpscaling ||
      rows % multiple != 0) {
    throw Error(
        "network: measured rows {} + n {} of {}, expected one in each {} and a multiple of {} rows "
        "in all",
        d.measured_rows.offset, d.measured_rows.stride, rows, kTulipUpscaling, multiple);
  }
  constexpr std::int64_t kValuesOfPixel = 32;  // with gradients, for each channel
  check_memory(kValuesOfPixel * shape_.channels * rows * d.sensor.columns, d);
}

LayerGraph Tulip::graph(const NetworkDescription& d, int columns, Purpose /*purpose*/,
                        const Engine& engine) const {
  const TensorShape input{1, d.sensor.rows() / d.measured_rows.stride, columns};
  TulipBuilder build{shape_, LayerGraph(input, engine)};
  LayerGraph& graph = build.graph;
  const int stages = static_cast<int>(shape_.heads.size());
  int x = graph.add("patch_embed.proj",
                    {.channels = shape_.channels,
                     .kernel = {1, 8},
                     .stride = {1, kTulipUpscaling},
                     .padding = {0, 2},
                     .start_limit = limit_of_taps(8)},
                    {0});
  x = build.norm("patch_embed.norm", x);
  std::vector<int> sides;
  for (int stage = 0; stage < stages; ++stage) {
    sides.push_back(x);
    const std::string name = fmt::format("layers.{}", stage);
    x = build.two_blocks(name, shape_.heads[stage], x);
    if (stage + 1 < stages) x = build.downsample(name + ".downsample", x);
  }
  x = build.upsample("first_patch_expanding", x);
  for (int i = 0; i + 1 < stages; ++i) {
    const int stage = stages - 2 - i;
    const int both = graph.add(
        "side", make_concatenation(graph.shape(x), graph.shape(sides[stage])), {x, sides[stage]});
    x = build.linear(fmt::format("skip_connection_layers.{}", i), build.channels(x), {both});
    const std::string name = fmt::format("layers_up.{}", i);
    x = build.two_blocks(name, shape_.heads[stage], x);
    if (stage > 0) x = build.upsample(name + ".upsample", x);
  }
  x = build.norm("norm_up", x);
  x = build.shuffled("ps_head.conv_expand.0", kTulipUpscaling * kTulipUpscaling * shape_.channels,
                     kHeadSlope, kTulipUpscaling, x);
  graph.add("decoder_pred", {.bias = false, .start_limit = limit_of_taps(shape_.channels)}, {x});
  return std::move(build.graph);
}

}  // namespace hqslam::nn
