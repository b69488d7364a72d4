#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "files/point_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxPlyFileBytes = std::size_t{1} << 31U;
constexpr std::size_t kMaxPlyPoints = std::size_t{1} << 26U;  // a large map
constexpr std::size_t kMaxProperties = 200;

struct PlyTypeName {
  std::string_view name;
  std::string_view other_name;
  StoredNumber stored;
};
constexpr std::array<PlyTypeName, 8> kPlyTypes = {{{"char", "int8", {'I', 1}},
                                                   {"uchar", "uint8", {'U', 1}},
                                                   {"short", "int16", {'I', 2}},
                                                   {"ushort", "uint16", {'U', 2}},
                                                   {"int", "int32", {'I', 4}},
                                                   {"uint", "uint32", {'U', 4}},
                                                   {"float", "float32", {'F', 4}},
                                                   {"double", "float64", {'F', 8}}}};

struct PlyHeader {
  bool ascii = false;
  std::size_t points = 0;
  std::size_t point_bytes = 0;
  std::vector<PointField> properties;
  std::size_t data_at = 0;
};

[[noreturn]] void fail_in_ply(const std::string& path, const std::string& expected,
                              std::string_view found) {
  throw Error("{}: expected {}, found '{}'; give a .ply file of points", path, expected,
              excerpt(found));
}

void add_property(PlyHeader& header, const std::vector<std::string_view>& words,
                  const std::string& path, std::string_view line) {
  const auto type = std::ranges::find_if(kPlyTypes, [&](const PlyTypeName& known) {
    return words.size() == 3 && (known.name == words[1] || known.other_name == words[1]);
  });
  if (type == kPlyTypes.end() || header.properties.size() >= kMaxProperties) {
    fail_in_ply(path, "a property TYPE NAME of a point", line);
  }
  header.properties.push_back({std::string(words[2]), type->stored, header.point_bytes});
  header.point_bytes += type->stored.bytes;
}

PlyHeader read_ply_header(std::string_view file, const std::string& path) {
  PlyHeader header;
  bool known_format = false;
  bool in_vertex = false;
  bool behind_vertex = false;
  for (std::size_t at = 0, line_number = 0; at < file.size(); ++line_number) {
    const std::size_t end = file.find('\n', at);
    if (end == std::string_view::npos) break;
    const std::string_view line = file.substr(at, end - at);
    at = end + 1;
    const std::vector<std::string_view> words = words_of(line);
    if (line_number == 0) {
      if (words.size() != 1 || words[0] != "ply")
        fail_in_ply(path, "a file that begins with 'ply'", line);
    } else if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
      continue;
    } else if (words[0] == "format") {
      header.ascii = words.size() > 1 && words[1] == "ascii";
      known_format = header.ascii || (words.size() > 1 && words[1] == "binary_little_endian");
      if (!known_format) fail_in_ply(path, "format ascii or binary_little_endian", line);
    } else if (words[0] == "element") {
      behind_vertex = behind_vertex || in_vertex;
      in_vertex = words.size() == 3 && words[1] == "vertex" && !behind_vertex;
      if (!in_vertex && !behind_vertex) fail_in_ply(path, "the points as the first element", line);
      if (!in_vertex) continue;
      const auto points = number_from<std::size_t>(words[2]);
      if (!points || *points > kMaxPlyPoints) {
        fail_in_ply(path, fmt::format("a number of points up to {}", kMaxPlyPoints), line);
      }
      header.points = *points;
    } else if (words[0] == "property") {
      if (in_vertex && !behind_vertex) add_property(header, words, path, line);
    } else if (words[0] == "end_header") {
      if (!known_format) fail_in_ply(path, "a line 'format'", "none");
      header.data_at = at;
      for (std::size_t i = 0; header.ascii && i < header.properties.size(); ++i) {
        header.properties[i].offset = i;
      }
      return header;
    } else {
      fail_in_ply(path, "a line of a .ply header", line);
    }
  }
  fail_in_ply(path, "a header that ends with 'end_header'", "its end");
}

}  // namespace

RawPoints read_ply_points(const std::string& path) {
  const std::string file = whole_file(path, "a .ply file", kMaxPlyFileBytes);
  const PlyHeader header = read_ply_header(file, path);
  const std::string_view data = std::string_view(file).substr(header.data_at);
  const PointFields fields = point_fields(header.properties, path, "properties");
  if (header.ascii) {
    AsciiPoints text(data, header.points, header.properties.size(), path);
    RawPoints points(fields, header.points);
    for (std::size_t i = 0; i < header.points; ++i) {
      const std::vector<double>& numbers = text.next();
      points.add(fields, [&](const PointField& field) { return numbers[field.offset]; });
    }
    return points;
  }
  if (header.points > data.size() / header.point_bytes) {
    fail_in_ply(path, fmt::format("{} points of {} bytes", header.points, header.point_bytes),
                fmt::format("{} bytes", data.size()));
  }
  RawPoints points(fields, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const char* const point = data.data() + i * header.point_bytes;
    points.add(fields, [&](const PointField& field) {
      return number_at(point + field.offset, field.stored);
    });
  }
  return points;
}

}  // namespace hqslam
