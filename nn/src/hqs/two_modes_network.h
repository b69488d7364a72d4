#pragma once

#include <vector>

#include "../kernels/row_kernels.h"
#include "hqslam/nn/network.h"
#include "two_modes_graph.h"

namespace hqslam::nn {

/// The unrolled network whose layers say two modes and the probability of a return for each pixel
/// (two_modes.h). For layers k = 1, 2, ...
///   H = measured rows as they are; other rows Z of the layer before, at first the start
///   Z = the likelier mode of G_k(H, what was measured, memory of the layer before)
/// all in y = ln(range in metres), on tiles that have one measured row each. Eq. 10a in the limit
/// b -> 0, where a measurement is kept as it is: what is known to a centimetre needs no penalty.
/// The start is linear in 1/range by the beams' true elevations; a measured pixel without a return
/// is filled from above (at the top: 20 m) and marked as empty.
class TwoModesNetwork final : public Network {
 public:
  /// columns: a multiple of two tiles'.
  TwoModesNetwork(const TwoModesShape& shape, const NetworkDescription& description, int columns,
                  InstructionSet instruction_set, int threads);

  std::int64_t multiply_adds() const override;
  void set_parameters(std::span<const float> parameters) override;
  const LiftedImage& lift(const RangeImage& measured, float tolerance_m) override;
  Trace trace(const RangeImage& measured) override;
  std::vector<NetworkStep> steps(const RangeImage& measured) override;
  double add_gradient(const RangeImage& measured, const RangeImage& truth,
                      const LossOptions& options, std::uint64_t seed,
                      std::span<float> d_parameters) override;

 private:
  /// One layer on its way.
  struct Layer {
    ConvolutionGraph graph;
    std::vector<Tensor> values;     ///< of the graph; the last is only filled for training
    std::vector<Tensor> gradients;  ///< of the values; made when first needed, as d_h
    Tensor d_h;
    Tensor h;            ///< tiles of ln range: H
    Tensor z;            ///< tiles of the computed pixels: ln of the chosen mode
    Tensor probability;  ///< of a return, as z
    std::int64_t parameters = 0;
  };
  /// A computed pixel of a tile.
  struct ComputedPixel {
    int channel = 0;     ///< among all pixels of the tile
    int phase = 0;       ///< column in the tile
    bool above = false;  ///< above the tile's measured row
  };

  void check(const RangeImage& measured) const;
  RangeImage in_metres(const Tensor& log_ranges) const;
  LayerTrace layer_trace(int layer) const;
  /// The rows above and below tile row `row` that a computed pixel lies between, clamped.
  int measured_row_above(const ComputedPixel& pixel, int row) const;
  int measured_row_below(const ComputedPixel& pixel, int row) const;
  void take_measured(const RangeImage& measured);
  void start_row(int row);
  void make_input_row(int layer, int row);
  kernels::TwoModesInput modes_input(int layer, std::size_t pixel, int row, const float* outputs,
                                     std::int64_t channel_stride) const;
  void next_h_row(int layer, int row, const float* memory, std::int64_t channel_stride);
  void say_modes(int layer, const RangeImage& measured, float tolerance_m);
  void run_layer(int layer, const RangeImage& measured, float tolerance_m);
  void finish_image_row(const RangeImage& measured, int row, const float* ranges,
                        const float* confidences);
  void forward_for_training(const RangeImage& measured);
  double backward_layer(int layer, const Tensor& truth, const LossOptions& options,
                        std::span<float> d_parameters);

  NetworkDescription description_;
  TwoModesShape shape_;
  TileSize tile_;
  int rows_;     ///< of the tiles
  int columns_;  ///< of the tiles
  int threads_;
  InstructionSet instruction_set_;
  std::vector<ComputedPixel> computed_;
  std::vector<float> weight_above_;  ///< of each image row between its measured neighbours
  Tensor measured_log_;              ///< tile columns x rows: one channel per column of a tile
  Tensor measured_inverse_;
  Tensor measured_valid_;
  std::vector<Layer> layers_;
  std::vector<std::vector<float>> scratch_;  ///< a row of a head's result and more, one per thread
  LiftedImage lifted_;
};

}  // namespace hqslam::nn
