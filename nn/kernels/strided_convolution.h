#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "convolution.h"
#include "hqslam/nn/instruction_set.h"
#include "row_kernels.h"
#include "tensor.h"

namespace hqslam::nn::kernels {

/// Memory that the methods of StridedConvolution work in; one per thread team.
struct ConvolutionScratch {
  /// One per thread: some rows of the wide tensor, their columns sorted by column mod stride. None
  /// without a stride.
  std::vector<Tensor> phases;
  std::vector<std::vector<float>> rows;  ///< one per thread
};

/// A convolution seen from both sides. The narrow side has one pixel per `stride` pixels of the
/// wide side, and the weights w are narrow channels x wide channels x kernel rows x kernel columns:
///   gather   narrow[a][y][x] = sum  w[a][b][i][j] wide[b][v][u]
///   scatter  wide[b][v][u]  += sum  w[a][b][i][j] narrow[a][y][x]
/// with v = y s + i - p and u = x s + j - p.
/// One is the adjoint of the other, so conv2d is gather forward and scatter backward, and
/// conv_transpose2d scatter forward and gather backward, with the weights in PyTorch's layout in
/// both cases. Beyond the edges both tensors continue according to their ColumnPadding.
///
/// Inside an OpenMP parallel region the threads of the team share the work and wait for each other
/// at the end; every value is computed by one thread in an order that does not depend on their
/// number.
class StridedConvolution {
 public:
  /// Plans for one pair of tensor shapes. `shape` is conv2d's: input channels are the wide side's,
  /// output channels the narrow side's. Throws Error if the tensors do not fit it, if their borders
  /// are too small, or if with zeros beyond the edge the padding of the columns is too small (a
  /// stride leaves columns over that the last tap would need) or too large for the border.
  StridedConvolution(const ConvolutionShape& shape, const Tensor& narrow, const Tensor& wide,
                     InstructionSet instruction_set);

  /// Rearranges the weights (narrow x wide x kernel rows x kernel columns).
  void set_weights(std::span<const float> weights);

  ConvolutionScratch make_scratch(int threads) const;

  /// bias: padded to whole blocks of kOutputBlock; may be null. Fills the border columns of the
  /// result too.
  void gather(const Tensor& wide, const float* bias, const LayerEnd& end, Tensor& narrow,
              ConvolutionScratch& scratch) const;
  /// One row of gather with stride 1, into memory of the caller's: output channels channel_stride
  /// floats apart, each with room for whole vectors of 16. By the calling thread alone.
  void gather_row(const Tensor& wide, const float* bias, int y, float* output,
                  std::int64_t channel_stride) const;
  void scatter(const Tensor& narrow, const float* bias, const LayerEnd& end, Tensor& wide,
               ConvolutionScratch& scratch) const;
  /// scatter with stride 1 and one kernel row for some rows alone, `first_row` and what follows it:
  /// all that `narrow` has. By the calling thread alone.
  void scatter_rows(const Tensor& narrow, int first_row, const LayerEnd& end, Tensor& wide) const;
  /// Defined in nn/training. Adds to gradient (the weights' layout): sum narrow[a][y][x] wide[b][y
  /// s + i - p][x s + j - p]. `narrow` may have some rows only, `first_row` and what follows it.
  /// One thread.
  void add_weight_gradient(const Tensor& narrow, int first_row, const Tensor& wide,
                           std::span<float> gradient, ConvolutionScratch& scratch) const;

 private:
  /// The taps that end in the wide pixels whose row and column have one phase (mod stride).
  struct ScatterPhase {
    std::vector<std::int64_t> tap_offset;
    std::vector<std::int64_t> weight_index;  ///< of each tap, for wide channel 0
    std::vector<float> weights;              ///< blocks of 8 wide channels x taps x 8
  };

  void check(const Tensor& narrow, const Tensor& wide) const;
  void check_columns_read(const Tensor& narrow, const Tensor& wide) const;
  void plan_gather(const Tensor& wide);
  /// Room for the wide rows that a block of narrow rows takes.
  Tensor make_phases() const;
  void plan_scatter(const Tensor& narrow);
  /// input: where the taps of a narrow row are counted from.
  AccumulateRow gather_task(const float* input, const float* bias) const;
  /// Wide rows as `gather` reads them, `row_stride` from one narrow row to the next.
  struct GatherRows {
    const float* first = nullptr;
    std::int64_t row_stride = 0;
  };
  /// Those of narrow rows `begin` to `end` - 1, at most kBlockRows with a stride: the wide tensor's
  /// or, sorted, the thread's own.
  GatherRows gather_rows(const Tensor& wide, int begin, int end, ConvolutionScratch& scratch) const;
  void sort_phases(const Tensor& wide, int first_row, int rows, Tensor& phases) const;
  /// Row `y` of the result, and how it ends.
  static void end_in(Tensor& result, const LayerEnd& end, int y, AccumulateRow& row);
  void scatter_taps(int phase, AccumulateRow& row) const;
  /// With stride 1; `row` has input and bias.
  void scatter_whole_row(AccumulateRow row, const LayerEnd& end, int wide_row, Tensor& wide) const;
  void scatter_row(const Tensor& narrow, const float* bias, const LayerEnd& end, int wide_row,
                   Tensor& wide, std::vector<float>& rows) const;

  /// With a stride, the narrow rows that go through all stages while they are in the cache.
  static constexpr int kBlockRows = 4;

  ConvolutionShape shape_;
  ColumnPadding padding_;
  int narrow_rows_ = 0;
  int narrow_columns_ = 0;
  int wide_rows_ = 0;
  int wide_columns_ = 0;
  const RowKernels* kernels_;
  std::vector<std::int64_t> gather_offset_;   ///< wide channel, kernel row, kernel column
  std::vector<float> gather_weights_;         ///< blocks of 8 narrow channels x taps x 8
  std::vector<ScatterPhase> scatter_phases_;  ///< row phase x stride + column phase
};

}  // namespace hqslam::nn::kernels
