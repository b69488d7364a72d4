#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "convolution.h"
#include "hqslam/nn/instruction_set.h"
#include "row_kernels.h"
#include "tensor.h"

namespace hqslam::nn::kernels {

/// A 3 x 3 convolution without stride, as conv2d defines it, in 16 multiplications for every four
/// outputs and input channel instead of 36: Winograd's minimal filtering F(2 x 2, 3 x 3), as Lavin
/// and Gray ("Fast algorithms for convolutional neural networks", CVPR 2016) use it for networks.
///
/// In one dimension two outputs of a filter g with three taps on four inputs d,
///   y0 = d0 g0 + d1 g1 + d2 g2,   y1 = d1 g0 + d2 g1 + d3 g2,
/// are six products, but
///   m0 = (d0 - d2) g0                   y0 = m0 + m1 + m2
///   m1 = (d1 + d2) (g0 + g1 + g2) / 2   y1 = m1 - m2 - m3
///   m2 = (d2 - d1) (g0 - g1 + g2) / 2
///   m3 = (d1 - d3) g2
/// makes them of four. As matrices: y = A^T [(G g) (B^T d)] with the products place by place.
/// In two dimensions the same along rows and along columns: a tile of 2 x 2 outputs on 4 x 4
/// inputs,
///   Y[o] = A^T [ sum_c (G g[o][c] G^T) (B^T d[c] B) ] A.
/// The sum over channels stands inside, so both transforms of images cost little where there are
/// many channels, and at each of the 16 places what remains is a product of matrices,
/// output channels x input channels by input channels x tiles: the loop of AccumulateRow.
///
/// Differences and halves of sums round a little more than the formula of conv2d: B^T d B is at
/// most 4 times and G g G^T at most 9/4 times as large as what it is made of.
/// tests/nn/winograd_convolution_test.cpp measures and bounds it.
class WinogradConvolution {
 public:
  /// Whether a convolution can be computed like this and is faster so.
  static bool suits(const ConvolutionShape& shape, const Tensor& input);

  /// Plans for one shape of image; input and output have the same rows, columns and padding. Throws
  /// Error if the kernel is not 3 x 3, there is a stride, or the padding is not 1.
  WinogradConvolution(const ConvolutionShape& shape, const Tensor& input,
                      InstructionSet instruction_set, int threads);

  /// Transforms the weights: output x input x 3 x 3. Throws Error for another number. adjoint: for
  /// the gradient with respect to the input, which is a convolution too: of an object whose input
  /// channels are the output channels of the weights, and the other way round.
  void set_weights(std::span<const float> weights, bool adjoint = false);

  /// Inside an OpenMP parallel region the threads of the team share the work and wait for each
  /// other at the end; the result does not depend on their number. Borders of the input must be
  /// filled; those of the output will be.
  void forward(const Tensor& input, const float* bias, const LayerEnd& end, Tensor& output) const;

  /// Defined in nn/training. Adds to d_weights. Y = A^T [U V] A place by place makes d U = V (A dY
  /// A^T) summed over the tiles, and U = G g G^T makes d g = G^T dU G: 16 multiplications for 36
  /// here too. One thread.
  void add_weight_gradient(const Tensor& input, const Tensor& d_output,
                           std::span<float> d_weights) const;

 private:
  static constexpr int kPlaces = 16;  ///< of a tile
  static constexpr int kVectorTiles = 16;
  static constexpr int kVectorColumns = 2 * kVectorTiles;
  /// A vector of tiles reads its own columns and one more on either side.
  static constexpr int kEdgeColumns = kVectorColumns + 2;

  /// The memory of one thread.
  struct Scratch {
    CacheLineFloats transformed;  ///< 16 places x input channels x tiles of a panel
    CacheLineFloats products;     ///< 16 places x output channels x tiles of a panel
    CacheLineFloats edge;         ///< four rows of the last vector's columns
    CacheLineFloats gradient;     ///< 16 places x input channels x output channels
  };
  /// The layout in the scratch of the tiles that go through all stages together, a panel.
  struct PanelShape {
    int vectors = 0;  ///< of 16 tiles
    std::int64_t input_place_stride = 0;
    std::int64_t output_place_stride = 0;
    std::vector<std::int64_t> channel_offset = {};  ///< within a place
  };
  /// Vectors of 16 tiles, counted row after row of tiles.
  struct Panel {
    const PanelShape& shape;
    int first = 0;
    int last = 0;
  };
  /// The vectors of a panel in one row of tiles.
  struct Run {
    int tile_row = 0;
    int vector = 0;  ///< in the row
    int vectors = 0;
    int tile = 0;  ///< in the panel
  };

  PanelShape panel_shape(int vectors) const;
  /// Calls visit for each row of tiles that the panel has a part of.
  template <typename Visit>
  void for_each_run(const Panel& panel, const Visit& visit) const {
    for (int first = panel.first; first < panel.last;) {
      const int tile_row = first / row_vectors_;
      const int last = std::min(panel.last, (tile_row + 1) * row_vectors_);
      visit(Run{.tile_row = tile_row,
                .vector = first % row_vectors_,
                .vectors = last - first,
                .tile = (first - panel.first) * kVectorTiles});
      first = last;
    }
  }
  Scratch& scratch_of_thread(const PanelShape& shape) const;
  void transform_input(const Tensor& input, const Panel& panel, Scratch& scratch) const;
  void transform_run(const Tensor& input, int channel, const Run& run, WinogradInputRow row,
                     Scratch& scratch) const;
  void multiply(const Panel& panel, Scratch& scratch) const;
  void transform_output(const float* bias, const LayerEnd& end, const Panel& panel,
                        const Scratch& scratch, Tensor& output) const;
  void transform_gradient(const Tensor& d_output, const Panel& panel, Scratch& scratch) const;
  void transform_gradient_run(const Tensor& d_output, int channel, const Run& run,
                              WinogradGradientRow row, Scratch& scratch) const;
  void correlate(const Panel& panel, Scratch& scratch) const;

  ConvolutionShape shape_;
  int rows_ = 0;
  int columns_ = 0;
  int tile_rows_ = 0;
  int row_vectors_ = 0;    ///< vectors of tiles in a row of tiles
  int rows_per_task_ = 0;  ///< rows of tiles
  const RowKernels* kernels_;
  PanelShape forward_panel_;
  PanelShape gradient_panel_;
  CacheLineFloats weights_;  ///< 16 places x blocks of 8 output channels x input channels x 8
};

}  // namespace hqslam::nn::kernels
