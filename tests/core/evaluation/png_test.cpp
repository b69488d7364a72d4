#include "hqslam/evaluation/png.h"

#include "testing.h"

using namespace hqslam;
using namespace hqslam::test;

namespace {

RgbImage an_image() {
  RgbImage image;
  image.rows = 2;
  image.columns = 3;
  image.pixels = {{{255, 0, 0}}, {{0, 255, 0}}, {{0, 0, 255}},
                  {{1, 2, 3}},   {{0, 0, 0}},   {{255, 255, 255}}};
  return image;
}

std::uint32_t big_endian_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return (std::uint32_t{bytes[at]} << 24U) | (std::uint32_t{bytes[at + 1]} << 16U) |
         (std::uint32_t{bytes[at + 2]} << 8U) | bytes[at + 3];
}

int brightness(const std::array<std::uint8_t, 3>& color) { return color[0] + color[1] + color[2]; }

}  // namespace

TEST_CASE("an encoded image has PNG's signature, the size of the image and 8-bit RGB") {
  const std::vector<std::uint8_t> bytes = encode_png(an_image());
  REQUIRE(bytes.size() > 40);
  const std::vector<std::uint8_t> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  CHECK(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 8) == signature);
  CHECK(big_endian_at(bytes, 16) == 3);
  CHECK(big_endian_at(bytes, 20) == 2);
  CHECK(bytes[24] == 8);
  CHECK(bytes[25] == 2);
  CHECK(encode_png(an_image()) == bytes);
}

TEST_CASE("the file holds the encoded bytes") {
  const TemporaryDirectory directory;
  write_png(an_image(), directory.file("a.png"));
  const std::vector<std::uint8_t> bytes = encode_png(an_image());
  CHECK(file_contents(directory.file("a.png")) == std::string(bytes.begin(), bytes.end()));
}

TEST_CASE("colours darken with the range and no return is black") {
  RangeImage image(1, 60);
  for (int column = 1; column < 60; ++column)
    image.at(0, column) = 2.0F * static_cast<float>(column);
  const RgbImage colored = color_by_range(image, 100.0);
  CHECK(colored.rows == 1);
  CHECK(colored.columns == 60);
  CHECK(brightness(colored.pixels[0]) == 0);
  for (int column = 2; column < 60; ++column) {
    CAPTURE(column);
    CHECK(brightness(colored.pixels[column]) <= brightness(colored.pixels[column - 1]));
    CHECK(brightness(colored.pixels[column]) > 0);
  }
  CHECK(colored.pixels[59] == colored.pixels[55]);       // both beyond the maximum
  CHECK(colored.pixels[59][2] > colored.pixels[59][0]);  // blue
}

TEST_CASE("images without pixels, unwritable files and ranges that span nothing are refused") {
  CHECK(refused_with([] { encode_png({}); }, "found 0 x 0"));
  RgbImage short_image = an_image();
  short_image.pixels.pop_back();
  CHECK(refused_with([&] { encode_png(short_image); }, "2 x 3", "5 pixels"));
  CHECK(refused_with([] { write_png(an_image(), "/nowhere/a.png"); }, "/nowhere"));
  CHECK(refused_with([] { color_by_range(RangeImage(1, 1), 0.5); }, "max_range_m", "found 0.5"));
}

TEST_CASE("between two colours lies their mixture, and beyond the last one is the last one") {
  constexpr std::array<Rgb, 3> kStops = {{{0, 0, 0}, {100, 50, 20}, {200, 50, 255}}};
  CHECK(color_between(kStops, 0.0) == kStops[0]);
  CHECK(color_between(kStops, 0.25) == Rgb{50, 25, 10});
  CHECK(color_between(kStops, 0.5) == kStops[1]);
  CHECK(color_between(kStops, 0.75) == Rgb{150, 50, 138});  // 137.5
  CHECK(color_between(kStops, 1.0) == kStops[2]);
  CHECK(color_between(kStops, 7.0) == kStops[2]);
  CHECK(color_between(kStops, -1.0) == kStops[0]);
}
