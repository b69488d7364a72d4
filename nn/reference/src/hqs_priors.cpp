#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scan.h"

// The learned priors of eq. 10b, Z = G(H).
namespace hqslam::nn::reference {
namespace {

/// Channels `first` to first + count - 1.
Image channels(const Image& image, int first, int count) {
  using Index = Eigen::array<Eigen::Index, 3>;
  return image.slice(Index{first, 0, 0}, Index{count, image.dimension(1), image.dimension(2)});
}

/// The choice at the end: Z = w_a above + w_b below + w_h H + r with (w_a, w_b, w_h, w_0) the
/// softmax of 4 times four scores; w_0 is the weight of "no return". scores: 5 x rows x columns
/// tiles in groups: above, below, here, nothing, r. At a depth jump a sum of features would have to
/// hit one range or the other exactly; a choice only has to be clear.
Image choice(Run& run, const std::string& prefix, const std::vector<Image>& scores, const Image& h,
             const Image& above, const Image& below) {
  Image z = h;
  std::vector<Image> weights(4, h);
  for (int y = 0; y < z.dimension(1); ++y) {
    for (int x = 0; x < z.dimension(2); ++x) {
      double total = 0.0;
      for (int g = 0; g < 4; ++g) {
        weights[g](0, y, x) = std::exp(4.0 * scores[g](0, y, x));
        total += weights[g](0, y, x);
      }
      for (Image& weight : weights) weight(0, y, x) /= total;
      z(0, y, x) = weights[0](0, y, x) * above(0, y, x) + weights[1](0, y, x) * below(0, y, x) +
                   weights[2](0, y, x) * h(0, y, x) + scores[4](0, y, x);
    }
  }
  const char* const names[] = {"above", "below", "here", "nothing"};
  for (int g = 0; g < 4; ++g) run.add(prefix + "choice." + names[g], weights[g]);
  run.add(prefix + "choice.correction", scores[4], "m", run.description.range_scale_m);
  return z;
}

/// H in the nearest measured row above (or below) each pixel; in a measured row its own.
Image nearest_measured_row(const Run& run, const Image& h, bool above) {
  Image image = h;
  const RowSelection rows = run.description.measured_rows;
  for (int y = 0; y < run.rows(); ++y) {
    const Between at = between(run, y);
    const int from = rows.offset + (above ? at.above : at.below) * rows.stride;
    for (int x = 0; x < run.columns(); ++x) image(0, y, x) = h(0, from, x);
  }
  return image;
}

}  // namespace

/// A U of convolutions on tiles (t = tile rows x tile columns, m channels of memory), eq. 10b of
/// DU-OR; the paper gives no sizes. Shapes for 4 x 4 tiles, 64 x 1024 pixels, channels 32, 32:
Image du_or_prior(Run& run, int k, const Image& h, const Image& above, const Image& below,
                  Image& memory) {
  const nlohmann::json& sizes = run.network["denoiser"];
  const int tile_rows = sizes["tile_rows"];
  const int tile_columns = sizes["tile_columns"];
  const int pixels = tile_rows * tile_columns;
  const int memory_channels = sizes["memory"];
  const double slope = sizes["negative_slope"];
  const auto levels = static_cast<int>(sizes["channels"].size());
  const std::string prefix = fmt::format("layers.{}.", k);
  const auto array = [&](const std::string& name) -> const Array& {
    const bool shared = run.network["shared_weights"];
    return run.parameters[fmt::format("layers.{}.", shared ? 0 : k) + name];
  };
  const auto named = [&](const std::string& name, const Image& image) {
    run.add(prefix + name, image);
    return image;
  };

  const Image tiles = tiled(h, tile_rows, tile_columns);  // 16 x 16 x 256
  if (k == 0) memory = zeros(memory_channels, tiles.dimension(1), tiles.dimension(2));
  // 32 x 16 x 256; Eigen concatenates nothing that is empty.
  const Image input = memory_channels == 0 ? tiles : Image(tiles.concatenate(memory, 0));
  std::vector<Image> down;  // 32 x 16 x 256, 32 x 8 x 128
  for (int level = 0; level < levels; ++level) {
    const std::string name = fmt::format("encoder.{}", level);
    down.push_back(
        named(name, activated(convolution(level == 0 ? input : down.back(), array(name + ".weight"),
                                          &array(name + ".bias"), level == 0 ? 1 : 2),
                              slope)));
  }
  Image x = named("bottleneck", activated(convolution(down.back(), array("bottleneck.weight"),
                                                      &array("bottleneck.bias")),
                                          slope));  // 32 x 8 x 128
  for (int level = levels - 2; level >= 0; --level) {
    const std::string name = fmt::format("decoder.{}", level);
    x = transposed_convolution(x, array(name + ".weight"), array(name + ".bias"));
    x = named(name, activated(x + down[level], slope));  // 32 x 16 x 256
  }
  const Image output = convolution(x, array("head.weight"), &array("head.bias"));  // 5 t + m
  std::vector<Image> scores;  // 5 of 1 x 64 x 1024
  for (int g = 0; g < 5; ++g)
    scores.push_back(untiled(output, g * pixels, tile_rows, tile_columns));
  // The paper's Z = G(H) has its neighbours from H, the other form from L.
  const bool of_h = sizes["neighbours"] == "h";
  Image z = of_h ? choice(run, prefix, scores, h, nearest_measured_row(run, h, true),
                          nearest_measured_row(run, h, false))
                 : choice(run, prefix, scores, h, above, below);
  memory = channels(output, 5 * pixels, memory_channels);
  if (memory_channels > 0) run.add(prefix + "memory", memory);
  return z;
}

/// Simple DU's: 3 x 3 convolutions on the whole image without bias, ReLU between them, zeros beyond
/// the edge, the same in every layer. 1 x rows x columns -> features x ... -> 1 x rows x columns.
Image simple_du_prior(Run& run, int k, const Image& h) {
  const int convolutions = run.network["denoiser"]["convolutions"];
  Image x = h;
  for (int i = 0; i < convolutions; ++i) {
    const bool last = i + 1 == convolutions;
    const Array& weight = run.parameters[fmt::format("layers.0.convolution.{}.weight", i)];
    x = activated(convolution(x, weight, nullptr, 1, Beyond::kZero), last ? 1.0 : 0.0);
    if (!last) run.add(fmt::format("layers.{}.convolution.{}", k, i), x);
  }
  return x;
}

}  // namespace hqslam::nn::reference
