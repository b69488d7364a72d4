#include <fmt/format.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <map>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/slam/occupancy_grid.h"

namespace hqslam::slam {

namespace {

constexpr std::size_t kMostYamlBytes = 65536;
constexpr std::size_t kMostImageBytes = 400'001'000;
constexpr std::array<std::uint8_t, 3> kShades = {205, 254, 0};  ///< by Occupancy

/// "key: value" per line, comments from # on; nothing is nested in such a file.
std::map<std::string, std::string> yaml_fields(const std::string& text) {
  const auto trimmed = [](std::string word) {
    word.erase(0, std::min(word.size(), word.find_first_not_of(" \t\r\"'")));
    word.erase(word.find_last_not_of(" \t\r\"'") + 1);
    return word;
  };
  std::map<std::string, std::string> fields;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, std::min(end, text.find('#', at)) - at);
    const std::size_t colon = line.find(':');
    if (colon != std::string::npos) {
      fields[trimmed(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
    }
    at = end + 1;
  }
  return fields;
}

/// The fields of a map's .yaml file.
struct MapDescription {
  std::string path;
  std::map<std::string, std::string> fields;

  [[noreturn]] void fail(const std::string& field, const std::string& expected) const {
    const auto found = fields.find(field);
    throw Error("{}: {}: expected {}, found {}", path, field, expected,
                found == fields.end() ? "nothing" : '"' + excerpt(found->second) + '"');
  }
  const std::string& text(const std::string& field) const {
    const auto found = fields.find(field);
    if (found == fields.end() || found->second.empty()) fail(field, "a value, as in a map of Nav2");
    return found->second;
  }
  double number(const std::string& field, double low, double high) const {
    const std::string& value = text(field);
    double number = 0.0;
    const char* const end = value.data() + value.size();
    const auto read = std::from_chars(value.data(), end, number);
    if (read.ec != std::errc() || read.ptr != end || !(number >= low && number <= high)) {
      fail(field, fmt::format("a number from {} to {}", low, high));
    }
    return number;
  }
  /// x and y of [x, y, yaw]; the yaw must be 0.
  Eigen::Vector2d origin_m() const {
    constexpr double kFarthestOrigin_m = 1e7;
    std::array<double, 3> values{};
    const std::string& list = text("origin");
    const char* at = list.data();
    const char* const end = at + list.size();
    for (double& value : values) {
      while (at != end && (*at == '[' || *at == ',' || *at == ' ')) ++at;
      const auto read = std::from_chars(at, end, value);
      if (read.ec != std::errc() || !(std::abs(value) <= kFarthestOrigin_m)) {
        fail("origin", "[x, y, yaw] in metres and radians");
      }
      at = read.ptr;
    }
    if (values[2] != 0.0) fail("origin", "a yaw of 0");
    return {values[0], values[1]};
  }
};

/// A binary PGM with 255 shades.
struct GreyImage {
  int rows = 0;
  int columns = 0;
  std::string pixels;
};

/// The next number of a PGM's header; `at` moves past it and the one character that follows.
int pgm_number(const std::string& bytes, std::size_t& at, const std::string& path) {
  while (at < bytes.size() &&
         (bytes[at] == '#' || std::isspace(static_cast<unsigned char>(bytes[at])) != 0)) {
    at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
  }
  int number = 0;
  const char* const begin = bytes.data() + at;
  const auto read = std::from_chars(begin, bytes.data() + bytes.size(), number);
  if (read.ec != std::errc() || number <= 0) {
    throw Error("{}: expected a binary PGM image (P5) with its size, found another file", path);
  }
  at = std::min(at + static_cast<std::size_t>(read.ptr - begin) + 1, bytes.size());
  return number;
}

GreyImage read_pgm(const std::string& path) {
  std::string bytes = whole_file(path, "a .pgm image", kMostImageBytes);
  std::size_t at = bytes.starts_with("P5") ? 2 : bytes.size();
  GreyImage image;
  image.columns = pgm_number(bytes, at, path);
  image.rows = pgm_number(bytes, at, path);
  const int shades = pgm_number(bytes, at, path);
  const std::size_t left = bytes.size() - at;
  const auto pixels =
      static_cast<std::uint64_t>(image.columns) * static_cast<std::uint64_t>(image.rows);
  if (shades != 255 || left != pixels) {
    throw Error("{}: expected {} x {} pixels of 255 shades, found {} bytes for them and {} shades",
                path, image.columns, image.rows, left, shades);
  }
  image.pixels = bytes.erase(0, at);
  return image;
}

}  // namespace

void write_occupancy_image(const OccupancyMap& map, const std::string& path) {
  std::string bytes = fmt::format("P5\n# written by hqslam\n{} {}\n255\n", map.columns, map.rows);
  bytes.reserve(bytes.size() + map.cells.size());
  for (const Occupancy cell : map.cells) {
    bytes.push_back(static_cast<char>(kShades[static_cast<std::size_t>(cell)]));
  }
  write_whole_file(path, bytes);
}

void write_occupancy_yaml(const OccupancyMap& map, const std::string& image,
                          const std::string& path) {
  // 205 is a share of 0.196 of black, which must be no less than free_thresh to be unknown.
  write_whole_file(path, fmt::format("# written by hqslam\nimage: {}\nmode: trinary\n"
                                     "resolution: {}\norigin: [{:.6f}, {:.6f}, 0.0]\nnegate: 0\n"
                                     "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                                     image, map.resolution_m, map.origin_m.x(), map.origin_m.y()));
}

OccupancyMap read_occupancy_map(const std::string& yaml_path) {
  const MapDescription description{
      yaml_path, yaml_fields(whole_file(yaml_path, "a map's .yaml file", kMostYamlBytes))};
  if (description.fields.contains("mode") && description.text("mode") != "trinary") {
    description.fail("mode", "trinary");
  }
  const bool negate = description.number("negate", 0.0, 1.0) != 0.0;
  const double occupied = description.number("occupied_thresh", 0.0, 1.0);
  const double free = description.number("free_thresh", 0.0, 1.0);
  OccupancyMap map;
  map.resolution_m = description.number("resolution", 1e-3, 100.0);
  map.origin_m = description.origin_m();
  const GreyImage image =
      read_pgm(std::filesystem::path(yaml_path).parent_path() / description.text("image"));
  map.rows = image.rows;
  map.columns = image.columns;
  map.cells.reserve(image.pixels.size());
  for (const char pixel : image.pixels) {
    const double shade = static_cast<unsigned char>(pixel) / 255.0;
    const double black = negate ? shade : 1.0 - shade;
    map.cells.push_back(black > occupied ? Occupancy::kOccupied
                        : black < free   ? Occupancy::kFree
                                         : Occupancy::kUnknown);
  }
  return map;
}

}  // namespace hqslam::slam
