#include "hqslam/slam/occupancy_grid.h"
#include "testing.h"

using namespace hqslam::slam;

namespace {

OccupancyMap small_occupancy_map() {
  using enum Occupancy;
  return {0.05, {-1.25, 3.5}, 2, 3, {kFree, kOccupied, kUnknown, kUnknown, kFree, kFree}};
}

const std::string kYaml =
    "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1.25, 3.5, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// The error of reading a map with these files.
std::string error_of(const std::string& yaml, const std::string& image) {
  const TemporaryDirectory folder;
  write_file(folder.file("map.yaml"), yaml);
  write_file(folder.file("map.pgm"), image);
  return error_message([&] { static_cast<void>(read_occupancy_map(folder.file("map.yaml"))); });
}

}  // namespace

TEST_CASE("a map is written as map_server reads it, top row first, and read back by cells") {
  const TemporaryDirectory folder;
  write_occupancy_image(small_occupancy_map(), folder.file("map.pgm"));
  CHECK(file_contents(folder.file("map.pgm")) ==
        std::string("P5\n# written by hqslam\n3 2\n255\n\xFE\x00\xCD\xCD\xFE\xFE", 37));
  write_occupancy_yaml(small_occupancy_map(), "map.pgm", folder.file("map.yaml"));
  CHECK(file_contents(folder.file("map.yaml")) ==
        "# written by hqslam\nimage: map.pgm\nmode: trinary\nresolution: 0.05\n"
        "origin: [-1.250000, 3.500000, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.196\n");
  const OccupancyMap map = read_occupancy_map(folder.file("map.yaml"));
  CHECK(map.cells == small_occupancy_map().cells);
  CHECK(map.at({-1.24, 3.56}) == Occupancy::kFree);
  CHECK(map.at({-1.16, 3.56}) == Occupancy::kOccupied);
  CHECK(map.at({-1.24, 3.54}) == Occupancy::kUnknown);
  CHECK(map.at({-1.26, 3.56}) == Occupancy::kUnknown);
}

TEST_CASE("a map as other programs write it is read: comments, quotes, negated, no mode") {
  CHECK(error_of("# a map\nimage: \"map.pgm\"  # beside\nresolution: 0.1\norigin: [0,0,0]\n"
                 "negate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.25\n",
                 std::string("P5 1 1 255\n\x10", 12)) == "no Error");
}

TEST_CASE("a broken map is refused in one line with what was expected") {
  const std::string image("P5\n3 2\n255\n\xFE\x00\xCD\xCD\xFE\xFE", 17);
  REQUIRE(error_of(kYaml, image) == "no Error");
  const std::vector<std::pair<std::string, std::string>> broken_lines = {
      {"trinary", "scale"},         {"0.05", "nan"},          {"0.05", "-1"},
      {"resolution: 0.05\n", ""},   {"3.5, 0.0]", "3.5]"},    {"3.5, 0.0]", "3.5, 0.5]"},
      {"-1.25", "1e300"},           {"map.pgm", "other.pgm"}, {"image: map.pgm", "image:"},
      {"negate: 0", "negate: what"}};
  for (const auto& [what, by] : broken_lines) {
    const std::string broken_line = by;
    CAPTURE(broken_line);
    CHECK(one_line_with(error_of(replaced_in(kYaml, what, by), image), "expected"));
  }
  for (const std::string& broken :
       {std::string("P2\n3 2\n255\n"), std::string("P5\n3 3\n255\n\0\0", 13), std::string("P5"),
        std::string("P5\n2000000000 2000000000\n255\n"), std::string("P5\n-3 2\n255\n"),
        std::string("P5\n#"), std::string("P5\n# a comment that is long\n12"), std::string()}) {
    CAPTURE(broken);
    CHECK(one_line_with(error_of(kYaml, broken), "expected"));
  }
}
