#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hqslam/nn/hqs/selection.h"
#include "hqslam/nn/hqs/tiles.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/tensor.h"

namespace hqslam::nn {

/// One array of learned parameters, in PyTorch's layout.
struct ParameterShape {
  std::string name;  ///< "encoder.0.weight"
  std::vector<std::int64_t> shape;
  std::int64_t elements() const;
};

/// What one pass through a denoiser computes. The gradients of the same values have the same shape.
struct DenoiserState {
  /// From the input to the output, what is between them after its activation.
  std::vector<Tensor> values;
  Tensor z;  ///< tiles of Z

  /// First the tiles of H, then the memory of the layer before.
  Tensor& input() { return values.front(); }
  const Tensor& input() const { return values.front(); }
  /// Of the last convolution; its last channels are the memory, and all there is where nobody will
  /// ask for gradients.
  Tensor& output() { return values.back(); }
  const Tensor& output() const { return values.back(); }
};

/// The learned prior G of eq. 10b: Z = G(H).
class Denoiser {
 public:
  virtual ~Denoiser() = default;

  virtual TileSize tile() const = 0;
  /// How columns continue beyond the edge.
  virtual ColumnPadding padding() const = 0;
  /// Channels that are handed from one HQS layer to the next beside the image.
  virtual int memory_channels() const = 0;
  virtual std::vector<ParameterShape> parameter_shapes() const = 0;
  /// Starting values for training, the same on every machine.
  virtual std::vector<float> initial_parameters(std::uint64_t seed) const = 0;
  /// Multiply-adds of one pass.
  virtual std::int64_t multiply_adds() const = 0;
  /// for_backward: with room for what `backward` needs.
  virtual DenoiserState make_state(bool for_backward = true) const = 0;

  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  virtual void set_parameters(std::span<const float> parameters) = 0;

  /// state.input() -> state.z and the memory. Called by all threads of a parallel region, they
  /// share the work. `dropout_seed` (training only) drops activations where the denoiser has
  /// dropout.
  virtual void forward(const Candidates& candidates, DenoiserState& state,
                       std::optional<std::uint64_t> dropout_seed = std::nullopt) = 0;
  /// In: gradient.z and the memory channels of gradient.output(). Out: gradient.input();
  /// d_parameters is added to. One thread.
  virtual void backward(const Candidates& candidates, const DenoiserState& state,
                        DenoiserState& gradient, std::span<float> d_parameters) = 0;
};

/// DU-OR's denoiser: strided convolutions down, transposed convolutions up, on tiles of pixels.
///   encoder.0     3x3, tile.pixels() + memory -> channels[0]
///   encoder.i     3x3, stride 2, channels[i - 1] -> channels[i]
///   bottleneck    3x3, the last channels -> as many
///   decoder.i     2x2 transposed, stride 2, channels[i + 1] -> channels[i], plus encoder.i
///   head          1x1, channels[0] -> 5 tile.pixels() scores and corrections, memory
/// with leaky ReLU after all but the head, whose result goes to `select`. The paper gives no sizes.
struct UShapedDenoiserShape {
  TileSize tile{4, 4};
  std::vector<int> channels{24, 32};
  int memory = 16;
  float negative_slope = 0.0F;
};
/// Throws Error with field, value and constraint.
void validate(const UShapedDenoiserShape& shape);
/// rows x columns: the image's. Throws Error if they cannot be halved often enough.
std::unique_ptr<Denoiser> make_u_shaped_denoiser(const UShapedDenoiserShape& shape, int rows,
                                                 int columns, InstructionSet instruction_set,
                                                 int threads);

/// Simple DU's denoiser: `convolutions` 3x3 convolutions of `features` channels on the whole image,
/// no bias, zeros beyond the edge, ReLU and dropout (training only) after all but the last.
struct PlainDenoiserShape {
  int features = 64;
  int convolutions = 5;
  float dropout = 0.05F;
};
/// Throws Error with field, value and constraint.
void validate(const PlainDenoiserShape& shape);
std::unique_ptr<Denoiser> make_plain_denoiser(const PlainDenoiserShape& shape, int rows,
                                              int columns, InstructionSet instruction_set,
                                              int threads);

}  // namespace hqslam::nn
