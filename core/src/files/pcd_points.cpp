#include <bit>
#include <cstring>
#include <optional>

#include "files/pcd_header.h"
#include "files/point_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and so are we");

namespace {

constexpr std::size_t kMaxPcdFileBytes = std::size_t{1} << 31U;  // maps are larger than scans
/// As much as the most points that a header may announce take with 16 bytes each.
constexpr std::size_t kMaxDecompressedBytes = std::size_t{1} << 30U;
/// No LZF stream grows by more than this: a reference of 3 bytes stands for at most 264.
constexpr std::size_t kLzfMaxRatio = 88;

void require_points(std::string_view data, const PcdHeader& header, const std::string& path) {
  if (header.point_bytes == 0 || header.points <= data.size() / header.point_bytes) return;
  throw Error("{}: truncated: expected {} points of {} bytes, found {} bytes; copy the file again",
              path, header.points, header.point_bytes, data.size());
}

/// The points of binary_compressed data, one field after the other.
std::string decompressed_points(std::string_view data, const PcdHeader& header,
                                const std::string& path) {
  std::uint32_t compressed_bytes = 0;
  std::uint32_t bytes = 0;
  constexpr std::size_t kSizes = sizeof(compressed_bytes) + sizeof(bytes);
  if (data.size() >= kSizes) {
    std::memcpy(&compressed_bytes, data.data(), sizeof(compressed_bytes));
    std::memcpy(&bytes, data.data() + sizeof(compressed_bytes), sizeof(bytes));
  }
  if (data.size() < kSizes || compressed_bytes > data.size() - kSizes) {
    throw Error("{}: truncated: expected {} compressed bytes, found {}; copy the file again", path,
                compressed_bytes, data.size() < kSizes ? 0 : data.size() - kSizes);
  }
  if (header.point_bytes != 0 &&
      (bytes % header.point_bytes != 0 || bytes / header.point_bytes != header.points)) {
    throw Error(
        "{}: expected {} points of {} bytes, found {} bytes when decompressed; write the file "
        "again",
        path, header.points, header.point_bytes, bytes);
  }
  if (bytes > kMaxDecompressedBytes) {
    throw Error(
        "{}: expected at most {} bytes when decompressed, found {}; leave out fields other than x "
        "y z",
        path, kMaxDecompressedBytes, bytes);
  }
  auto decompressed = lzf_decompressed(data.substr(kSizes, compressed_bytes), bytes);
  if (!decompressed) {
    throw Error(
        "{}: expected LZF data that stand for {} bytes, found damaged data; copy the file again",
        path, bytes);
  }
  return std::move(*decompressed);
}

}  // namespace

// A stream is a row of commands that begin with a control byte c:
//   c < 32        c + 1 literal bytes follow
//   c >= 32       repeat: length (c >> 5) + 2, where 7 in c >> 5 adds the next byte to the length;
//                 distance back (c & 31) * 256 + the byte after + 1. It may overlap its own output.
std::optional<std::string> lzf_decompressed(std::string_view stream, std::size_t size) {
  if (size / kLzfMaxRatio > stream.size()) return std::nullopt;
  std::string result;
  result.reserve(size);
  std::size_t at = 0;
  const auto next_byte = [&]() { return static_cast<unsigned char>(stream[at++]); };
  while (at < stream.size()) {
    const std::size_t control = next_byte();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > stream.size() - at || length > size - result.size()) return std::nullopt;
      result.append(stream.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = (control >> 5) + 2;
    if (stream.size() - at < (length == 9 ? 2U : 1U)) return std::nullopt;
    if (length == 9) length += next_byte();
    const std::size_t distance = (control & 31) * 256 + next_byte() + 1;
    if (distance > result.size() || length > size - result.size()) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) result.push_back(result[result.size() - distance]);
  }
  if (result.size() != size) return std::nullopt;
  return result;
}

RawPoints read_pcd_points(const std::string& path) {
  const std::string file = whole_file(path, "a .pcd file", kMaxPcdFileBytes);
  const PcdHeader header = parse_pcd_header(file, path);
  const std::string_view data = std::string_view(file).substr(header.data_offset_bytes);
  std::optional<AsciiPoints> text;
  std::string decompressed;
  if (header.data == PcdData::kAscii) {
    text.emplace(data, header.points, header.point_numbers, path);
  } else if (header.data == PcdData::kBinary) {
    require_points(data, header, path);
  } else {
    decompressed = decompressed_points(data, header, path);
  }
  const PointFields fields = point_fields(header.fields, path);
  for (const PointField* field : {fields.x, fields.y, fields.z, fields.ring, fields.time,
                                  fields.intensity, fields.confidence}) {
    if (field == nullptr || field->count > 0) continue;
    throw Error(
        "{}: field '{}': expected one number per point, found none; give a .pcd file with COUNT 1 "
        "for it",
        path, field->name);
  }
  RawPoints points(fields, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const double* const numbers = text ? text->next().data() : nullptr;
    points.add(fields, [&](const PointField& field) {
      if (text) return numbers[field.offset];
      const char* const at = header.data == PcdData::kBinary
                                 ? data.data() + i * header.point_bytes + field.offset
                                 : decompressed.data() + header.points * field.offset +
                                       i * field.stored.bytes * field.count;
      return number_at(at, field.stored);
    });
  }
  return points;
}

}  // namespace hqslam
