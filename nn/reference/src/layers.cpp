#include "layers.h"

#include <algorithm>

namespace hqslam::nn::reference {

Image convolution(const Image& in, const Array& weight, const Array* bias, int stride) {
  const auto outputs = static_cast<int>(weight.shape[0]);
  const auto kernel = static_cast<int>(weight.shape[2]);
  Image out(outputs, in.rows / stride, in.columns / stride, in.circular);
  for (int o = 0; o < outputs; ++o) {
    for (int y = 0; y < out.rows; ++y) {
      for (int x = 0; x < out.columns; ++x) {
        double value = bias == nullptr ? 0.0 : bias->values[o];
        const double* w =
            &weight.values[static_cast<std::size_t>(o) * in.channels * kernel * kernel];
        for (int i = 0; i < in.channels; ++i) {
          for (int r = 0; r < kernel; ++r) {
            for (int c = 0; c < kernel; ++c) {
              value +=
                  *w++ * in.beyond(i, stride * y + r - kernel / 2, stride * x + c - kernel / 2);
            }
          }
        }
        out.at(o, y, x) = value;
      }
    }
  }
  return out;
}

Image transposed_convolution(const Image& in, const Array& weight, const Array& bias) {
  const auto outputs = static_cast<int>(weight.shape[1]);
  Image out(outputs, 2 * in.rows, 2 * in.columns, in.circular);
  for (int o = 0; o < outputs; ++o) {
    for (int y = 0; y < out.rows; ++y) {
      for (int x = 0; x < out.columns; ++x) {
        double value = bias.values[o];
        for (int i = 0; i < in.channels; ++i) {
          const double w = weight.values[((i * outputs + o) * 2 + y % 2) * 2 + x % 2];
          value += w * in.at(i, y / 2, x / 2);
        }
        out.at(o, y, x) = value;
      }
    }
  }
  return out;
}

Image activated(Image image, double slope) {
  for (double& value : image.values) value = std::max(value, slope * value);
  return image;
}

Image sum(Image a, const Image& b) {
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] += b.values[i];
  return a;
}

}  // namespace hqslam::nn::reference
