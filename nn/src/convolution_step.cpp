#include "convolution_step.h"

#include <vector>

namespace hqslam::nn {
namespace {

std::int64_t multiply_adds(const ConvolutionShape& shape, const Tensor& of_pixels) {
  return shape.weights() * of_pixels.rows() * of_pixels.columns();
}

}  // namespace

NetworkStep convolution_step(const std::string& name, Conv2d& layer, const Tensor& input,
                             const LayerEnd& end, Tensor& output) {
  const ConvolutionShape& shape = layer.shape();
  const std::vector<float> weight(static_cast<std::size_t>(shape.weights()), 0.5F);
  return {.name = name,
          .multiply_adds = multiply_adds(shape, output),
          .run = [&layer, &input, end, &output] { layer.forward(input, end, output); },
          .reference =
              [&shape, weight, &input, rows = output.rows(), columns = output.columns()] {
                Tensor result(shape.output_channels, rows, columns, input.padding());
                conv2d_reference(shape, weight, {}, input, result);
              }};
}

NetworkStep convolution_step(const std::string& name, ConvTranspose2d& layer, const Tensor& input,
                             const LayerEnd& end, Tensor& output) {
  return {.name = name,
          .multiply_adds = multiply_adds(layer.shape(), input),
          .run = [&layer, &input, end, &output] { layer.forward(input, end, output); }};
}

}  // namespace hqslam::nn
