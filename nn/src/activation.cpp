#include "activation.h"

namespace hqslam::nn {

void leaky_relu_backward(float slope, const Tensor& output, Tensor& d_values) {
  for (int channel = 0; channel < output.channels(); ++channel) {
    for (int y = 0; y < output.rows(); ++y) {
      const float* out = output.row(channel, y);
      float* gradient = d_values.row(channel, y);
#pragma omp simd
      for (int x = 0; x < output.columns(); ++x) {
        gradient[x] *= out[x] > 0.0F ? 1.0F : slope;
      }
      d_values.fill_border(channel, y);
    }
  }
}

}  // namespace hqslam::nn
