#include "pcd_points.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "hqslam/core/error.h"
#include "lzf.h"

namespace hqslam {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and so are we");

namespace {

/// As much as the most points that a header may announce take with 16 bytes each.
constexpr std::size_t kMaxDecompressedBytes = std::size_t{1} << 30U;

}  // namespace

PcdPoints::PcdPoints(std::string_view file, const PcdHeader& header, const std::string& path)
    : header_(header), path_(path) {
  const std::string_view data = file.substr(header.data_offset_bytes);
  if (header.data == PcdData::kAscii) {
    ascii_.emplace(data, header.points, header.point_numbers, path);
  }
  if (header.data == PcdData::kBinary) read_binary(data);
  if (header.data == PcdData::kBinaryCompressed) read_compressed(data);
}

void PcdPoints::go_to(std::size_t point) {
  point_ = point;
  if (ascii_) numbers_ = ascii_->next().data();
}

double PcdPoints::value(const PointField& field) const {
  if (ascii_) return numbers_[field.offset];
  const char* const at = header_.data == PcdData::kBinary
                             ? points_ + point_ * header_.point_bytes + field.offset
                             : decompressed_.data() + header_.points * field.offset +
                                   point_ * field.stored.bytes * field.count;
  return number_at(at, field.stored);
}

void PcdPoints::read_binary(std::string_view data) {
  const bool fits = header_.point_bytes == 0 || header_.points <= data.size() / header_.point_bytes;
  if (!fits) {
    throw Error(
        fmt::format("{}: truncated: expected {} points of {} bytes, found {} bytes; copy "
                    "the file again",
                    path_, header_.points, header_.point_bytes, data.size()));
  }
  points_ = data.data();
}

void PcdPoints::read_compressed(std::string_view data) {
  std::uint32_t compressed_bytes = 0;
  std::uint32_t bytes = 0;
  constexpr std::size_t kSizes = sizeof(compressed_bytes) + sizeof(bytes);
  if (data.size() >= kSizes) {
    std::memcpy(&compressed_bytes, data.data(), sizeof(compressed_bytes));
    std::memcpy(&bytes, data.data() + sizeof(compressed_bytes), sizeof(bytes));
  }
  if (data.size() < kSizes || compressed_bytes > data.size() - kSizes) {
    throw Error(
        fmt::format("{}: truncated: expected {} compressed bytes, found {}; copy the file "
                    "again",
                    path_, compressed_bytes, data.size() < kSizes ? 0 : data.size() - kSizes));
  }
  const bool fits = header_.point_bytes == 0 || (bytes % header_.point_bytes == 0 &&
                                                 bytes / header_.point_bytes == header_.points);
  if (!fits) {
    throw Error(
        fmt::format("{}: expected {} points of {} bytes, found {} bytes when decompressed; "
                    "write the file again",
                    path_, header_.points, header_.point_bytes, bytes));
  }
  if (bytes > kMaxDecompressedBytes) {
    throw Error(
        fmt::format("{}: expected at most {} bytes when decompressed, found {}; leave out fields "
                    "other than x y z",
                    path_, kMaxDecompressedBytes, bytes));
  }
  auto decompressed = lzf_decompressed(data.substr(kSizes, compressed_bytes), bytes);
  if (!decompressed) {
    throw Error(
        fmt::format("{}: expected LZF data that stand for {} bytes, found damaged data; "
                    "copy the file again",
                    path_, bytes));
  }
  decompressed_ = std::move(*decompressed);
}

}  // namespace hqslam
