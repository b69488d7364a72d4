#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "beam_parameters.h"
#include "graph/layer_graph.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/trace.h"
#include "measurement.h"
#include "tiles.h"

namespace hqslam::nn {

/// What one pass through a prior computes; the gradients of these values have the same shapes.
struct PriorState {
  /// From the input to the output, what is between them after its activation.
  LayerGraph::Values values;
  Tensor z;              ///< tiles of Z
  Tensor part{};         ///< gradients: room for some rows of the last convolution's
  Tensor neighbours{};   ///< gradients: of H through the neighbours of other pixels, as z
  Tensor own_h{};        ///< tiles of H, where the input does not begin with them
  Tensor probability{};  ///< of a return, as z, if the prior has it

  /// First the tiles of H, then the memory of the layer before, unless own_h has H.
  Tensor& input() { return values.front(); }
  const Tensor& input() const { return values.front(); }
  /// The result of the last convolution; its last channels are the memory, and the only ones where
  /// no gradients are needed.
  Tensor& output() { return values.back(); }
  const Tensor& output() const { return values.back(); }
  Tensor& h() { return own_h.channels() > 0 ? own_h : input(); }
  const Tensor& h() const { return own_h.channels() > 0 ? own_h : input(); }
};

/// The options of a pass.
struct PriorPass {
  /// The pass of layer k, whose dropout differs from its neighbours'.
  PriorPass of_layer(int k) const {
    PriorPass own = *this;
    if (dropout_seed) own.dropout_seed = *dropout_seed * 1000 + k * 10;
    return own;
  }

  std::optional<std::uint64_t> dropout_seed = std::nullopt;  ///< training only: what to drop
  float tolerance_m = 0.5F;                                  ///< of the confidence
  UpsampledImage* upsampled = nullptr;  ///< for the result of a prior with a confidence
};

/// The learned prior G of eq. 10b, Z = G(H): convolutions, and what stands before and after them.
/// Training needs more of it: PriorBackward.
class Prior {
 public:
  virtual ~Prior() = default;

  TileSize tile() const { return tile_; }
  LayerGraph& graph() { return graph_; }
  /// How columns continue beyond the edge.
  ColumnPadding padding() const { return graph_.shape(0).padding; }
  std::vector<ParameterShape> parameter_shapes() const {
    return beams_ ? beams_->shapes() : graph_.parameter_shapes();
  }
  std::int64_t parameters() const;
  /// Multiply-adds of one pass.
  std::int64_t multiply_adds() const { return graph_.multiply_adds(); }
  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  void set_parameters(std::span<const float> parameters);
  /// Not null if they are those of every table of beams.
  const BeamParameters* beams() const { return beams_ ? &*beams_ : nullptr; }
  /// Channels that are handed from one layer to the next beside the image.
  virtual int memory_channels() const { return 0; }
  /// Tiles of an image, all zero.
  Tensor make_tiles() const {
    const TensorShape& input = graph_.shape(0);
    return {tile_.pixels(), input.rows, input.columns, input.padding};
  }
  /// for_backward: with room for what `backward` needs.
  virtual PriorState make_state(bool for_backward = true) const;
  /// L in a unit of the prior's own; null: range / range_scale_m (ScaledRanges).
  virtual Measurement* measurement() { return nullptr; }

  /// Makes what else the input has in a row of tiles whose H is there. before: the layer before,
  /// null in the first. By the calling thread alone.
  virtual void take_row(int /*row*/, const PriorState* /*before*/, PriorState& /*state*/) {}
  /// Eq. 10b: state.h() -> state.z, and the memory. Called by all threads of a parallel region,
  /// maybe not at the same time; they share the work and wait for each other at the end.
  virtual void forward(const Candidates& candidates, PriorState& state, const PriorPass& pass) = 0;

  /// Adds the tensors between H and Z to the trace: the convolutions' results.
  virtual void add_inner(const Measurement& measurement, const PriorState& state,
                         const std::string& prefix, Trace& trace) const;

 protected:
  Prior(LayerGraph graph, TileSize tile);

  LayerGraph graph_;
  std::optional<BeamParameters> beams_;

 private:
  TileSize tile_;
};

/// A kind of prior with its sizes.
struct PriorDescription {
  nlohmann::ordered_json sizes;  ///< the fields that the kind's `read` takes
  TileSize multiple = {};        ///< images have rows and columns that are multiples of these
  bool scan_memory = false;      ///< uses what earlier scans measured
  TileSize any_beams = {};       ///< its tiles if its parameters are BeamParameters
  /// The convolutions for images of rows x columns, such multiples.
  std::function<LayerGraph(int rows, int columns, const Engine&)> graph = {};
  /// The prior with that graph, for images of `columns` columns.
  std::function<std::unique_ptr<Prior>(LayerGraph, const NetworkDescription&, int columns,
                                       const Engine&)>
      make;
  /// The same prior on tiles of other rows; empty: its parameters are for these alone.
  std::function<PriorDescription(int tile_rows)> with_tile_rows = {};
  /// Changes the graph's starting values; empty: they stay.
  std::function<void(std::span<float>)> start = {};
  /// Throws Error unless the prior fits sensor and measured rows; empty: every prior does.
  std::function<void(const NetworkDescription&)> check = {};
};

/// Throws Error unless rows and columns are such multiples.
void check_image(const PriorDescription& prior, int rows, int columns);
/// The convolutions for the sensor's images, on the thread that calls.
LayerGraph graph_of(const PriorDescription& prior, const NetworkDescription& network);
/// The parameters of the prior for the sensor.
std::vector<ParameterShape> parameter_shapes(const PriorDescription& prior,
                                             const NetworkDescription& network);
std::vector<float> initial_parameters(const PriorDescription& prior,
                                      const NetworkDescription& network, std::uint64_t seed);

/// Channels `first` to first + channels - 1 (0: all from `first` on) of a tensor, without borders.
TracedTensor traced(std::string name, const Tensor& tensor, int first = 0, int channels = 0);

/// The tile.pixels() channels from `first` on, tiles, as an image of pixels without a unit.
TracedTensor traced_pixels(std::string name, const Tensor& tensor, int first, TileSize tile);

}  // namespace hqslam::nn
