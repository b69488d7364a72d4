#pragma once

#include <memory>
#include <vector>

#include "direct_network.h"

namespace hqslam::nn {

/// TULIP (Yang et al., "TULIP: Transformer for upsampling of LiDAR point clouds", CVPR 2024), with
/// its names: a U-shaped Swin transformer. C channels, s stages with h_0, ... heads, windows of 2 x
/// 8 tokens:
///   patch_embed          1 x 8 convolution with stride 1 x 4, going round, C; layer norm
///   layers.i             two blocks of 2^i C channels, the second with shifted windows; but for
///                        the last: downsample, patches of 2 x 2 merged, layer norm, linear to
///                        2^(i+1) C
///   first_patch_expanding  1 x 1 to twice as many channels, pixel shuffle 2
///   skip_connection_layers.i, layers_up.i   what stage s - 2 - i began with put beside it,
///                        linear to half, two blocks; but for the last: upsample, as
///                        first_patch_expanding
///   norm_up, ps_head     layer norm, 1 x 1 to 16 C, leaky ReLU, pixel shuffle 4
///   decoder_pred         1 x 1 to 1, no bias
/// A block: x + proj(attention(qkv(norm1(x)))), then x + fc2(gelu(fc1(norm2(x)))) with 4 times as
/// many channels between. The paper has 96 channels and 3, 6, 12, 24 heads, and DropPath when
/// training, which is left out here.
struct TulipShape {
  int channels = 16;
  std::vector<int> heads{2, 4, 8};
  /// An addition to the paper: the last column attends to the first.
  bool circular_attention = false;
};
/// Rows of the result and columns of a token for each measured row and token.
inline constexpr int kTulipUpscaling = 4;

/// "tulip".
class Tulip final : public DirectArchitecture {
 public:
  /// Throws Error with field, value and constraint.
  explicit Tulip(TulipShape shape);

  std::string_view name() const override { return "tulip"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override;
  LayerGraph graph(const NetworkDescription& description, int columns, Purpose purpose,
                   const Engine& engine) const override;
  DirectPlan plan() const override { return {.logarithmic = true}; }

 private:
  TulipShape shape_;
};

std::shared_ptr<const Architecture> read_tulip(JsonFields& network);

}  // namespace hqslam::nn
