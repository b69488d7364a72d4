#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <optional>

#include "files/point_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
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
constexpr std::size_t kMaxFields = 256;
constexpr std::size_t kMaxCount = 65536;
constexpr std::size_t kMaxHeaderLines = 64;
constexpr std::size_t kMaxPoints = std::size_t{1} << 26U;  // a large map; scans are a hundredth

enum class PcdData { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
  std::vector<PointField> fields;
  std::size_t points = 0;
  std::size_t point_bytes = 0;
  std::size_t point_numbers = 0;
  PcdData data = PcdData::kAscii;
  std::size_t data_offset_bytes = 0;
};

using Words = std::vector<std::string_view>;

template <typename... Values>
[[noreturn]] void fail_in_pcd(const std::string& path, fmt::format_string<Values...> complaint,
                              Values&&... values) {
  throw Error("{}: {}; give a .pcd file of version 0.7", path,
              fmt::format(complaint, std::forward<Values>(values)...));
}

std::size_t size_from(std::string_view word, const std::string& key, std::size_t max,
                      const std::string& path) {
  const auto value = hqslam::number_from<std::size_t>(word);
  if (!value || *value > max) {
    fail_in_pcd(path, "{} in the header: expected a whole number up to {}, found '{}'", key, max,
                excerpt(word));
  }
  return *value;
}

/// The lines of the header by their first word, up to and with DATA.
std::map<std::string, Words> header_lines(std::string_view file, const std::string& path,
                                          std::size_t& data_offset_bytes) {
  std::map<std::string, Words> lines;
  std::size_t at = 0;
  for (std::size_t line = 0; line < kMaxHeaderLines && at < file.size(); ++line) {
    const std::size_t end = file.find('\n', at);
    if (end == std::string_view::npos) break;
    const Words words = words_of(file.substr(at, end - at));
    at = end + 1;
    if (words.empty() || words[0].starts_with('#')) continue;
    lines[std::string(words[0])] = Words(words.begin() + 1, words.end());
    if (words[0] == "DATA") {
      data_offset_bytes = at;
      return lines;
    }
  }
  fail_in_pcd(path, "expected a .pcd header that ends with a DATA line, found '{}'",
              excerpt(file.substr(0, std::min(file.find('\n'), file.size()))));
}

/// The words after `key`; as many as `expected` unless that is 0.
const Words& line_of(const std::map<std::string, Words>& lines, const std::string& key,
                     std::size_t expected, const std::string& path) {
  const auto found = lines.find(key);
  if (found == lines.end()) fail_in_pcd(path, "expected a line {} in the header, found none", key);
  if (expected != 0 && found->second.size() != expected) {
    fail_in_pcd(path, "{} in the header: expected {} values, found {}", key, expected,
                found->second.size());
  }
  return found->second;
}

void require_type(const PointField& field, std::string_view type, const std::string& path) {
  const std::size_t size = field.stored.bytes;
  const bool power_of_two = size == 1 || size == 2 || size == 4 || size == 8;
  const bool known = type == "F" ? size == 4 || size == 8 : (type == "I" || type == "U");
  if (!known || !power_of_two) {
    fail_in_pcd(
        path,
        "field '{}': expected type F of 4 or 8 bytes or I or U of 1, 2, 4 or 8, found {} of {}",
        excerpt(field.name), excerpt(type), size);
  }
}

void add_fields(const std::map<std::string, Words>& lines, const std::string& path,
                PcdHeader& header) {
  const Words& names = line_of(lines, "FIELDS", 0, path);
  if (names.empty() || names.size() > kMaxFields) {
    fail_in_pcd(path, "FIELDS in the header: expected 1 to {} names, found {}", kMaxFields,
                names.size());
  }
  const Words& sizes = line_of(lines, "SIZE", names.size(), path);
  const Words& types = line_of(lines, "TYPE", names.size(), path);
  const bool has_counts = lines.contains("COUNT");
  for (std::size_t i = 0; i < names.size(); ++i) {
    PointField field;
    field.name = std::string(names[i]);
    field.stored.bytes = size_from(sizes[i], "SIZE", 8, path);
    require_type(field, types[i], path);
    field.stored.type = types[i][0];
    if (has_counts) {
      const Words& counts = line_of(lines, "COUNT", names.size(), path);
      field.count = size_from(counts[i], "COUNT", kMaxCount, path);
    }
    field.offset = header.data == PcdData::kAscii ? header.point_numbers : header.point_bytes;
    header.point_bytes += field.stored.bytes * field.count;
    header.point_numbers += field.count;
    header.fields.push_back(std::move(field));
  }
}

std::size_t points_of(const std::map<std::string, Words>& lines, const std::string& path) {
  const auto number = [&](const std::string& key) {
    return size_from(line_of(lines, key, 1, path)[0], key, kMaxPoints, path);
  };
  const std::size_t width = number("WIDTH");
  const std::size_t height = number("HEIGHT");
  const bool fits = height == 0 || width <= kMaxPoints / height;
  const std::size_t points = lines.contains("POINTS") ? number("POINTS") : width * height;
  if (!fits || points != width * height) {
    fail_in_pcd(path, "POINTS in the header: expected WIDTH x HEIGHT = {} x {}, found {}", width,
                height, points);
  }
  return points;
}

PcdData data_of(const std::map<std::string, Words>& lines, const std::string& path) {
  const std::string_view data = line_of(lines, "DATA", 1, path)[0];
  if (data == "ascii") return PcdData::kAscii;
  if (data == "binary") return PcdData::kBinary;
  if (data == "binary_compressed") return PcdData::kBinaryCompressed;
  fail_in_pcd(path, "DATA in the header: expected ascii, binary or binary_compressed, found '{}'",
              excerpt(data));
}

/// Parses the header at the beginning of a .pcd file. Throws Error.
PcdHeader parse_pcd_header(std::string_view file, const std::string& path) {
  PcdHeader header;
  const auto lines = header_lines(file, path, header.data_offset_bytes);
  header.data = data_of(lines, path);
  add_fields(lines, path, header);
  header.points = points_of(lines, path);
  return header;
}

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
