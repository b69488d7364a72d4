#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "../graph/layer_graph.h"
#include "../tiles.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/trace.h"
#include "measurement.h"

namespace hqslam::nn {

/// What one pass through a prior computes. The gradients of the same values have the same shape.
struct PriorState {
  /// From the input to the output, what is between them after its activation.
  LayerGraph::Values values;
  Tensor z;              ///< tiles of Z
  Tensor part{};         ///< gradients: room for some rows of the last convolution's
  Tensor own_h{};        ///< tiles of H, where the input does not begin with them
  Tensor probability{};  ///< of a return, as z; of priors that say it

  /// First the tiles of H, then the memory of the layer before, unless own_h has H.
  Tensor& input() { return values.front(); }
  const Tensor& input() const { return values.front(); }
  /// Of the last convolution; its last channels are the memory, and all there is where nobody will
  /// ask for gradients.
  Tensor& output() { return values.back(); }
  const Tensor& output() const { return values.back(); }
  Tensor& h() { return own_h.channels() > 0 ? own_h : input(); }
  const Tensor& h() const { return own_h.channels() > 0 ? own_h : input(); }
};

/// How a pass goes.
struct PriorPass {
  /// The same for layer k, which drops others than its neighbours.
  PriorPass of_layer(int k) const {
    PriorPass own = *this;
    if (dropout_seed) own.dropout_seed = *dropout_seed * 1000 + k * 10;
    return own;
  }

  std::optional<std::uint64_t> dropout_seed = std::nullopt;  ///< training only: what to drop
  float tolerance_m = 0.5F;                                  ///< of the confidence
  UpsampledImage* upsampled = nullptr;  ///< for the result of a prior that says how sure it is
};

/// What the loss compares Z with.
struct LossTarget {
  const Tensor& truth;                        ///< tiles of Measurement::put_truth
  std::optional<RowSelection> restored_rows;  ///< rows that count as exact
  float share = 1.0F;                         ///< of this layer in the loss
};

/// The learned prior G of eq. 10b, Z = G(H): convolutions, and what stands before and after them.
class Prior {
 public:
  virtual ~Prior() = default;

  TileSize tile() const { return tile_; }
  /// How columns continue beyond the edge.
  ColumnPadding padding() const { return graph_.shape(0).padding; }
  std::vector<ParameterShape> parameter_shapes() const { return graph_.parameter_shapes(); }
  std::int64_t parameters() const;
  /// Multiply-adds of one pass.
  std::int64_t multiply_adds() const { return graph_.multiply_adds(); }
  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  void set_parameters(std::span<const float> parameters) { graph_.set_parameters(parameters); }
  /// Starting values for training, the same on every machine.
  virtual std::vector<float> initial_parameters(std::uint64_t seed) const {
    return graph_.initial_parameters(seed);
  }
  /// Channels that are handed from one layer to the next beside the image.
  virtual int memory_channels() const { return 0; }
  /// Tiles of an image, all zero.
  Tensor make_tiles() const {
    const TensorShape& input = graph_.shape(0);
    return {tile_.pixels(), input.rows, input.columns, input.padding};
  }
  /// How many values the tensors of one layer hold.
  std::int64_t values() const {
    return graph_.values() +
           2 * tile_.pixels() * graph_.shape(0).values() / graph_.shape(0).channels;
  }
  /// for_backward: with room for what `backward` needs.
  virtual PriorState make_state(bool for_backward = true) const;
  /// For `backward` to work in; output() has the memory channels at least.
  virtual PriorState make_gradient() const { return make_state(); }
  /// L in a unit of the prior's own; null: range / range_scale_m (ScaledRanges).
  virtual Measurement* measurement() { return nullptr; }

  /// A row of tiles of H is there: makes what else the input has in that row. before: of the layer
  /// before, null in the first. By the calling thread alone.
  virtual void take_row(int /*row*/, const PriorState* /*before*/, PriorState& /*state*/) {}
  /// Eq. 10b: state.h() -> state.z, and the memory. Called by all threads of a parallel region,
  /// maybe not at the same time; they share the work and wait for each other at the end.
  virtual void forward(const Candidates& candidates, PriorState& state, const PriorPass& pass) = 0;

  /// The loss of Z. Writes `share` times its gradient to gradient.z, or wherever `backward` looks
  /// for it. One thread. As it is: the mean absolute error.
  virtual double loss(const PriorState& state, const LossTarget& target,
                      PriorState& gradient) const;
  /// In: gradient.z and the memory channels of gradient.output(). Out: gradient.input();
  /// d_parameters is added to. One thread.
  virtual void backward(const Candidates& candidates, const PriorState& state, PriorState& gradient,
                        std::span<float> d_parameters) = 0;

  /// Adds what lies between H and Z, for people who want to look: the convolutions' results.
  virtual void add_inner(const Measurement& measurement, const PriorState& state,
                         const std::string& prefix, Trace& trace) const;
  /// The parts of `forward`, for measurements (Network::steps).
  virtual std::vector<NetworkStep> steps(const Candidates& /*candidates*/, PriorState& state,
                                         const PriorPass& /*pass*/) {
    return graph_.steps(state.values);
  }

 protected:
  Prior(LayerGraph graph, TileSize tile);

  LayerGraph graph_;

 private:
  TileSize tile_;
};

/// A kind of prior with its sizes.
struct PriorDescription {
  nlohmann::ordered_json sizes;  ///< the fields that the kind's `read` takes
  TileSize multiple;             ///< images have a multiple of so many rows and columns
  bool has_rows = false;         ///< some parameters belong to rows of the sensor's image
  bool scan_memory = false;      ///< looks at what earlier scans measured
  /// For such images of rows x columns.
  std::function<std::unique_ptr<Prior>(const NetworkDescription&, int rows, int columns,
                                       const Engine&)>
      make;
  /// Throws Error unless the prior fits sensor and measured rows; empty: all do.
  std::function<void(const NetworkDescription&)> check = {};
};

/// For images of rows x columns. Throws Error unless they are such multiples.
std::unique_ptr<Prior> make_prior(const PriorDescription& prior, const NetworkDescription& network,
                                  int rows, int columns, const Engine& engine);
/// Throws Error unless rows and columns are such multiples.
void check_image(const PriorDescription& prior, int rows, int columns);
/// For images as small as can be, to ask about parameters.
std::unique_ptr<Prior> smallest_prior(const PriorDescription& prior,
                                      const NetworkDescription& network);

/// Mean of |Z - truth| over all pixels, "no return" counting as range 0. Rows of the result that
/// get their measured ranges back count as exact (`restored_rows`; nothing: there are none). Writes
/// `share` times the gradient d loss / d Z (0 where the two are equal). Tiles.
double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile,
               std::optional<RowSelection> restored_rows, float share, Tensor& d_z);

/// Channels `first` to first + channels - 1 (0: all from `first` on) of a tensor, without borders.
TracedTensor traced(std::string name, const Tensor& tensor, int first = 0, int channels = 0);

/// The tile.pixels() channels from `first` on, tiles, as an image of pixels without a unit.
TracedTensor traced_pixels(std::string name, const Tensor& tensor, int first, TileSize tile);

}  // namespace hqslam::nn
