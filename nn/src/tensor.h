#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <unsupported/Eigen/CXX11/Tensor>
#include <vector>

namespace hqslam::nn {

/// The values of a tensor beyond its first and last column. Beyond its first and last row they are
/// always zero.
enum class ColumnPadding {
  kCircular,  ///< a whole scan: the last column is a neighbour of the first
  kZero,
};

/// Memory that begins with a cache line: the widest vectors of a row then never span two.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::size_t kAlignment = 64;

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{kAlignment}));
  }
  void deallocate(T* memory, std::size_t) {
    ::operator delete (memory, std::align_val_t{kAlignment});
  }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};
using CacheLineFloats = std::vector<float, CacheLineAllocator<float>>;

/// Values of shape channels x rows x columns, float32, each channel with a border around it, so
/// that a convolution reads beyond the edges without a test for them.
///
/// Memory: an Eigen tensor of rows with their borders x channels x columns with their borders. Row
/// y of channel c begins at row(c, y); row(c, -border_rows()) to row(c, rows() + border_rows() - 1)
/// and in each of them columns -kBorderColumns to padded_columns() + kBorderColumns - 1 may be
/// read. Columns from columns() to padded_columns() hold whatever a vector kernel left there; they
/// are part of the border. Every row begins with a cache line, because the widest vectors are as
/// long. Eigen aligns to 16 bytes, so the tensor has one row of channels more than are used, and
/// the first line begins up to 15 values behind its start.
class Tensor {
 public:
  using Values = Eigen::Tensor<float, 3, Eigen::RowMajor>;
  /// Columns to the left and right of each row. Also the number of floats that the widest vector
  /// holds, so that a row can always be processed in whole vectors.
  static constexpr int kBorderColumns = 16;

  Tensor() = default;
  /// All zero. Throws Error unless channels, rows, columns >= 1 and 0 <= border_rows <= 16.
  Tensor(int channels, int rows, int columns, ColumnPadding padding, int border_rows = 1);
  Tensor(const Tensor& other) { *this = other; }
  Tensor& operator=(const Tensor& other);
  Tensor(Tensor&&) noexcept = default;
  Tensor& operator=(Tensor&&) noexcept = default;
  ~Tensor() = default;
  /// A tensor with a shape but without values, for planning.
  static Tensor shape_alone(int channels, int rows, int columns, ColumnPadding padding,
                            int border_rows = 1);

  int channels() const { return channels_; }
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  int padded_columns() const { return padded_columns_; }
  int border_rows() const { return border_rows_; }
  ColumnPadding padding() const { return padding_; }
  std::int64_t channel_stride() const { return padded_columns_ + 2 * kBorderColumns; }
  std::int64_t row_stride() const { return channel_stride() * channels_; }

  float* row(int channel, int row) { return values_.data() + offset(channel, row); }
  const float* row(int channel, int row) const { return values_.data() + offset(channel, row); }
  /// All of it: rows with their borders x channels x columns with their borders.
  Eigen::TensorMap<const Values> with_borders() const {
    return {values_.data() + first_, rows_ + 2 * border_rows_, channels_, channel_stride()};
  }
  float& at(int channel, int row_, int column) { return row(channel, row_)[column]; }
  float at(int channel, int row_, int column) const { return row(channel, row_)[column]; }

  /// Makes the border columns of one row continue the row according to padding().
  void fill_border(int channel, int row) {
    if (padding_ == ColumnPadding::kCircular && columns_ == padded_columns_) {
      // At least as wide as the border, and what is called for every row of every layer.
      constexpr std::size_t kBytes = kBorderColumns * sizeof(float);
      float* values = this->row(channel, row);
      std::memcpy(values - kBorderColumns, values + columns_ - kBorderColumns, kBytes);
      std::memcpy(values + columns_, values, kBytes);
    } else {
      fill_other_border(channel, row);
    }
  }
  /// Fills the border columns of every row of every channel.
  void fill_borders();
  void set_zero();

 private:
  void fill_other_border(int channel, int row);
  std::int64_t offset(int channel, int row) const {
    return first_ + channel * channel_stride() + (row + border_rows_) * row_stride() +
           kBorderColumns;
  }
  void allocate();

  int channels_ = 0;
  int rows_ = 0;
  int columns_ = 0;
  int padded_columns_ = 0;
  int border_rows_ = 0;
  ColumnPadding padding_ = ColumnPadding::kCircular;
  Values values_;
  std::int64_t first_ = 0;  ///< where in values_ the first cache line begins
};

// Groups of channels of tensors, such as tiles and memory side by side. copy and clear: called by
// all threads of a parallel region, which share the work.

/// Rows of the channels from `from_channel` on, borders too.
void copy_channels(const Tensor& from, int from_channel, int channels, Tensor& to, int to_channel);

/// One row, by the calling thread alone.
void copy_channels_row(const Tensor& from, int from_channel, int channels, int row, Tensor& to,
                       int to_channel);

/// The channels of `from` from `first` on are added to as many of `to`, up to the last of either,
/// without the borders. By the calling thread alone.
void add_channels(const Tensor& from, int first, Tensor& to);

/// Zero from channel `from_channel` on, borders too.
void clear_channels(int from_channel, Tensor& tensor);
/// One row, by the calling thread alone.
void clear_channels_row(int from_channel, int row, Tensor& tensor);

}  // namespace hqslam::nn
