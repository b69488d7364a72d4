#include "layers.h"

namespace hqslam::nn::reference {

Image zeros(std::int64_t channels, std::int64_t rows, std::int64_t columns) {
  Image image(channels, rows, columns);
  image.setZero();
  return image;
}

double value_at(const Image& image, Beyond beyond, int channel, int row, int column) {
  const auto columns = static_cast<int>(image.dimension(2));
  if (beyond == Beyond::kOtherEnd) column = (column + columns) % columns;
  const bool inside = row >= 0 && row < image.dimension(1) && column >= 0 && column < columns;
  return inside ? image(channel, row, column) : 0.0;
}

Image convolution(const Image& in, const Array& weight, const Array* bias, int stride,
                  Beyond beyond) {
  const auto w = weight.weights();  // outputs x inputs x kernel x kernel
  const auto kernel = static_cast<int>(w.dimension(2));
  Image out(w.dimension(0), in.dimension(1) / stride, in.dimension(2) / stride);
  for (int o = 0; o < out.dimension(0); ++o) {
    for (int y = 0; y < out.dimension(1); ++y) {
      for (int x = 0; x < out.dimension(2); ++x) {
        double value = bias == nullptr ? 0.0 : bias->values[o];
        for (int i = 0; i < in.dimension(0); ++i) {
          for (int r = 0; r < kernel; ++r) {
            for (int c = 0; c < kernel; ++c) {
              value += w(o, i, r, c) * value_at(in, beyond, i, stride * y + r - kernel / 2,
                                                stride * x + c - kernel / 2);
            }
          }
        }
        out(o, y, x) = value;
      }
    }
  }
  return out;
}

Image transposed_convolution(const Image& in, const Array& weight, const Array& bias) {
  const auto w = weight.weights();  // inputs x outputs x 2 x 2
  Image out(w.dimension(1), 2 * in.dimension(1), 2 * in.dimension(2));
  for (int o = 0; o < out.dimension(0); ++o) {
    for (int y = 0; y < out.dimension(1); ++y) {
      for (int x = 0; x < out.dimension(2); ++x) {
        double value = bias.values[o];
        for (int i = 0; i < in.dimension(0); ++i) {
          value += w(i, o, y % 2, x % 2) * in(i, y / 2, x / 2);
        }
        out(o, y, x) = value;
      }
    }
  }
  return out;
}

Image activated(const Image& image, double slope) { return image.cwiseMax(image * slope); }

}  // namespace hqslam::nn::reference
