#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "../tensor.h"
#include "../tiles.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/parameter_shape.h"
#include "selection.h"

namespace hqslam::nn {

/// What one pass through a denoiser computes. The gradients of the same values have the same shape.
struct DenoiserState {
  /// From the input to the output, what is between them after its activation.
  std::vector<Tensor> values;
  Tensor z;       ///< tiles of Z
  Tensor part{};  ///< gradients: room for some rows of the last convolution's

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
  /// For `backward` to work in; output() has the memory channels at least.
  virtual DenoiserState make_gradient() const { return make_state(); }

  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  virtual void set_parameters(std::span<const float> parameters) = 0;

  /// state.input() -> state.z and the memory. Called by all threads of a parallel region, maybe not
  /// at the same time; they share the work and wait for each other at the end. `dropout_seed`
  /// (training only) drops activations where the denoiser has dropout.
  virtual void forward(const Candidates& candidates, DenoiserState& state,
                       std::optional<std::uint64_t> dropout_seed = std::nullopt) = 0;
  /// In: gradient.z and the memory channels of gradient.output(). Out: gradient.input();
  /// d_parameters is added to. One thread.
  virtual void backward(const Candidates& candidates, const DenoiserState& state,
                        DenoiserState& gradient, std::span<float> d_parameters) = 0;

  /// The parts of `forward`, for measurements (Network::steps).
  virtual std::vector<NetworkStep> steps(const Candidates& /*candidates*/,
                                         DenoiserState& /*state*/) {
    return {};
  }
};

/// A kind of denoiser with its sizes.
struct DenoiserDescription {
  std::string kind;              ///< as in the registry
  nlohmann::ordered_json sizes;  ///< the fields that the kind's `read` takes
  TileSize multiple;             ///< images have a multiple of so many rows and columns
  /// For such images of rows x columns.
  std::function<std::unique_ptr<Denoiser>(int rows, int columns, InstructionSet, int threads)> make;
};

/// Throws Error unless rows and columns are such multiples.
void check_image(const DenoiserDescription& description, int rows, int columns);
/// The same.
std::unique_ptr<Denoiser> make_denoiser(const DenoiserDescription& description, int rows,
                                        int columns, InstructionSet instruction_set, int threads);
/// For images as small as can be, to ask about parameters.
std::unique_ptr<Denoiser> smallest_denoiser(const DenoiserDescription& description);

struct NamedDenoiser {
  const char* kind;
  /// Takes the sizes out of the fields of "denoiser". Throws Error.
  DenoiserDescription (*read)(JsonFields& sizes);
};
/// All there are: those of denoisers.cpp, and what was added.
const std::vector<NamedDenoiser>& denoisers();
/// For a program with a denoiser of its own; before it reads any network.
void add_denoiser(const NamedDenoiser& denoiser);

}  // namespace hqslam::nn
