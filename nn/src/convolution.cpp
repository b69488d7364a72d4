#include "convolution.h"

#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

void check(const char* field, int value, int least, int most) {
  if (value < least || value > most) {
    throw Error("convolution: {} is {}, expected {} to {}", field, value, least, most);
  }
}

}  // namespace

void validate(const ConvolutionShape& shape) {
  constexpr int kMostChannels = 4096;
  constexpr int kMostKernel = 15;
  constexpr int kMostStride = 8;
  constexpr int kMostColumnStride = 2;  // kernels split and merge even and odd columns
  check("input_channels", shape.input_channels, 1, kMostChannels);
  check("output_channels", shape.output_channels, 1, kMostChannels);
  check("kernel_rows", shape.kernel_rows, 1, kMostKernel);
  check("kernel_columns", shape.kernel_columns, 1, kMostKernel);
  check("stride", shape.stride, 1, kMostStride);
  check("stride_columns", shape.column_stride(), 1, kMostColumnStride);
  check("padding_rows", shape.padding_rows, 0, kMostKernel);
  check("padding_columns", shape.padding_columns, 0, kMostKernel);
}

ConvolutionShape adjoint_of(ConvolutionShape shape) {
  std::swap(shape.input_channels, shape.output_channels);
  return shape;
}

int convolved_size(int size, int kernel, int stride, int padding) {
  return (size + 2 * padding - kernel) / stride + 1;
}

}  // namespace hqslam::nn
