#include "tulip.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "parameters.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
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
      throw Error(
          fmt::format("network: {} heads for {} channels, expected 4, 8, ... {} channels for each",
                      heads, channels, kGreatestDepth));
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
  return (kTulipUpscaling * kTulipWindowColumns) << (shape_.heads.size() - 1);
}

void Tulip::validate(const NetworkDescription& d) const {
  const int rows = d.sensor.rows();
  const int multiple = (kTulipUpscaling * kTulipWindowRows) << (shape_.heads.size() - 1);
  if (d.measured_rows.stride != kTulipUpscaling || d.measured_rows.offset >= kTulipUpscaling ||
      rows % multiple != 0) {
    throw Error(fmt::format(
        "network: measured rows {} + n {} of {}, expected one in each {} and a multiple of {} rows "
        "in all",
        d.measured_rows.offset, d.measured_rows.stride, rows, kTulipUpscaling, multiple));
  }
  constexpr std::int64_t kValuesOfPixel = 32;  // with gradients, for each channel
  check_memory(kValuesOfPixel * shape_.channels * rows * d.sensor.columns, d);
}

LayerGraph Tulip::graph(const NetworkDescription& d, int columns, Purpose /*purpose*/,
                        const Engine& engine) const {
  return tulip_graph(shape_,
                     {1, d.sensor.rows() / d.measured_rows.stride, columns,
                      ColumnPadding::kCircular},
                     engine);
}

}  // namespace hqslam::nn
