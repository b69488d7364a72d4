#include "hqslam/core/npy.h"

#include <bit>
#include <limits>
#include <utility>

#include "files/npy_format.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"

namespace hqslam {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and so are we");

namespace {

/// Space for the largest header of the arrays written here, so that it can grow in place.
constexpr std::size_t kWrittenHeaderBytes = 128;
constexpr std::int64_t kMaxImageSide = 65536;

void require_range_images(const NpyHeader& header, bool or_bytes, const std::string& path) {
  if (header.dtype != "<f4" && !(or_bytes && header.dtype == "|u1")) {
    throw Error("{}: expected float32 values ('<f4'), found '{}'; convert with array.astype('<f4')",
                path, excerpt(header.dtype));
  }
  if (header.fortran_order) {
    throw Error("{}: expected C order, found Fortran order; convert with numpy.ascontiguousarray",
                path);
  }
  const auto& shape = header.shape;
  const bool fits = (shape.size() == 3 || (shape.size() == 4 && shape[3] == 1)) && shape[1] >= 1 &&
                    shape[1] <= kMaxImageSide && shape[2] >= 1 && shape[2] <= kMaxImageSide;
  if (!fits) {
    throw Error(
        "{}: expected range images of shape (N, rows, columns) or (N, rows, columns, 1), found {}; "
        "reshape the array",
        path, npy_shape_text(shape));
  }
}

/// The data may be longer than the shape implies by up to one image, as after writing was
/// interrupted.
void require_data(const NpyHeader& header, std::int64_t value_bytes, std::int64_t file_bytes,
                  const std::string& path) {
  const std::int64_t found = file_bytes - header.data_offset_bytes;
  const std::int64_t image_bytes = header.shape[1] * header.shape[2] * value_bytes;
  const bool long_enough = header.shape[0] <= found / image_bytes;
  if (long_enough && found - header.shape[0] * image_bytes <= image_bytes) return;
  throw Error(
      "{}: {}: expected {} images of {} bytes for shape {}, found {} bytes; copy or write the file "
      "again",
      path, long_enough ? "too long" : "truncated", header.shape[0], image_bytes,
      npy_shape_text(header.shape), found);
}

template <typename T>
constexpr const char* dtype_of() {
  return sizeof(T) == 1 ? "|u1" : sizeof(T) == 4 ? "<f4" : "<f8";
}

}  // namespace

NpyStackReader::NpyStackReader(const std::string& path, bool or_bytes)
    : path_(path), stream_(open_file(path, "an .npy file")) {
  const NpyHeader header = read_npy_header(stream_, path);
  require_range_images(header, or_bytes, path);
  value_bytes_ = header.dtype == "|u1" ? 1 : sizeof(float);
  stream_.seekg(0, std::ios::end);
  require_data(header, value_bytes_, static_cast<std::int64_t>(stream_.tellg()), path);
  images_ = header.shape[0];
  rows_ = static_cast<int>(header.shape[1]);
  columns_ = static_cast<int>(header.shape[2]);
  data_offset_bytes_ = header.data_offset_bytes;
}

RangeImage NpyStackReader::read(std::int64_t image) {
  if (image < 0 || image >= images_) {
    throw Error("{}: expected an image index from 0 to {}, found {}", path_, images_ - 1, image);
  }
  RangeImage result(rows_, columns_);
  const std::int64_t bytes = std::ssize(result.range_m) * value_bytes_;
  stream_.clear();
  stream_.seekg(data_offset_bytes_ + image * bytes);
  stream_.read(reinterpret_cast<char*>(result.range_m.data()), bytes);
  if (!stream_) {
    throw Error(
        "{}: truncated: expected {} bytes for image {}, found {}; the file changed while it was "
        "read",
        path_, bytes, image, stream_.gcount());
  }
  if (value_bytes_ == 1) {  // bytes at the front: from the back none is overwritten unread
    const auto* values = reinterpret_cast<const std::uint8_t*>(result.range_m.data());
    for (std::size_t i = result.range_m.size(); i-- > 0;) result.range_m[i] = values[i];
  }
  return result;
}

template <typename T>
NpyArrayWriter<T>::NpyArrayWriter(const std::string& path, std::vector<std::int64_t> item_shape)
    : path_(path), stream_(path, std::ios::binary), item_shape_(std::move(item_shape)) {
  if (!stream_) {
    throw Error("{}: cannot be written; check that the folder exists and is writable", path);
  }
  item_elements_ = 1;
  for (const std::int64_t size : item_shape_) {
    if (size < 1 || static_cast<std::size_t>(size) >
                        std::numeric_limits<std::uint32_t>::max() / item_elements_) {
      throw Error("{}: item shape {} is empty or too large", path, npy_shape_text(item_shape_));
    }
    item_elements_ *= static_cast<std::size_t>(size);
  }
  write_header();
}

template <typename T>
void NpyArrayWriter<T>::append(std::span<const T> item) {
  if (item.size() != item_elements_) {
    throw Error("{}: expected an item of {} values, found {}", path_, item_elements_, item.size());
  }
  stream_.seekp(0, std::ios::end);
  stream_.write(reinterpret_cast<const char*>(item.data()),
                static_cast<std::streamsize>(item.size_bytes()));
  stream_.flush();  // the data are in the file before the header counts them
  ++items_;
  write_header();
}

template <typename T>
void NpyArrayWriter<T>::write_header() {
  std::vector<std::int64_t> shape = {items_};
  shape.insert(shape.end(), item_shape_.begin(), item_shape_.end());
  const std::string header = npy_header_bytes(dtype_of<T>(), shape, kWrittenHeaderBytes);
  if (header.size() > kWrittenHeaderBytes) {
    throw Error("{}: item shape {} has too many dimensions", path_, npy_shape_text(item_shape_));
  }
  stream_.seekp(0);
  stream_.write(header.data(), static_cast<std::streamsize>(header.size()));
  stream_.flush();
  if (!stream_) {
    throw Error("{}: could not be written; check the free space of the disk", path_);
  }
}

template class NpyArrayWriter<float>;
template class NpyArrayWriter<double>;
template class NpyArrayWriter<std::uint8_t>;

NpyStackWriter::NpyStackWriter(const std::string& path, int rows, int columns)
    : path_(path), rows_(rows), columns_(columns), writer_(path, {rows, columns}) {}

void NpyStackWriter::append(const RangeImage& image) {
  if (image.rows != rows_ || image.columns != columns_) {
    throw Error("{}: expected images of {} x {}, found {} x {}", path_, rows_, columns_, image.rows,
                image.columns);
  }
  writer_.append(image.range_m);
}

}  // namespace hqslam
