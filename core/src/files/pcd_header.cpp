#include "files/pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/words.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxFields = 256;
constexpr std::size_t kMaxCount = 65536;
constexpr std::size_t kMaxHeaderLines = 64;
constexpr std::size_t kMaxPoints = std::size_t{1} << 26U;  // a large map; scans are a hundredth

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

}  // namespace

PcdHeader parse_pcd_header(std::string_view file, const std::string& path) {
  PcdHeader header;
  const auto lines = header_lines(file, path, header.data_offset_bytes);
  header.data = data_of(lines, path);
  add_fields(lines, path, header);
  header.points = points_of(lines, path);
  return header;
}

}  // namespace hqslam
