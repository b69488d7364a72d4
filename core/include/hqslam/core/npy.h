#pragma once

#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam {

/// The header of an .npy file (versions 1.0, 2.0 and 3.0), as far as hqslam reads it.
struct NpyHeader {
  std::string dtype;  ///< numpy's descr, "<f4"
  bool fortran_order = false;
  std::vector<std::int64_t> shape;
  std::int64_t data_offset_bytes = 0;
};
/// Parses a header, checking every size against the length of the file. Throws Error.
/// Source: numpy.lib.format.
NpyHeader read_npy_header(std::istream& stream, const std::string& path);

/// An .npy stack of range images read one image at a time: float32 metres, N x H x W or
/// N x H x W x 1; or, if asked for, of bytes, which are read as numbers from 0 to 255. Throws
/// Error.
class NpyStackReader {
 public:
  explicit NpyStackReader(const std::string& path, bool or_bytes = false);
  std::int64_t images() const { return images_; }
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  /// Values as stored: NaN and negative values are the caller's to judge.
  RangeImage read(std::int64_t image);

 private:
  std::string path_;
  std::ifstream stream_;
  std::int64_t images_ = 0;
  int rows_ = 0;
  int columns_ = 0;
  std::int64_t value_bytes_ = 0;
  std::int64_t data_offset_bytes_ = 0;
};

/// Writes an array of shape N x item_shape, T float ("<f4"), double ("<f8") or std::uint8_t
/// ("|u1"), item by item. The header is rewritten after every item, so that the file is valid
/// whenever writing stops. Throws Error.
template <typename T>
class NpyArrayWriter {
 public:
  NpyArrayWriter(const std::string& path, std::vector<std::int64_t> item_shape);
  /// As many values as item_shape has elements, in C order.
  void append(std::span<const T> item);

 private:
  void write_header();
  std::string path_;
  std::ofstream stream_;
  std::int64_t items_ = 0;
  std::vector<std::int64_t> item_shape_;
  std::size_t item_elements_ = 0;
};
extern template class NpyArrayWriter<float>;
extern template class NpyArrayWriter<double>;
extern template class NpyArrayWriter<std::uint8_t>;

/// Writes a stack of range images (N x rows x columns, "<f4") image by image; the file is valid
/// after every image. Throws Error.
class NpyStackWriter {
 public:
  NpyStackWriter(const std::string& path, int rows, int columns);
  void append(const RangeImage& image);

 private:
  std::string path_;
  int rows_;
  int columns_;
  NpyArrayWriter<float> writer_;
};

}  // namespace hqslam
