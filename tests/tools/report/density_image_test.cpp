#include "report/density_image.h"

#include <doctest/doctest.h>

#include <string_view>

namespace hqslam::tools {
namespace {

std::string base64_of(std::string_view text) { return base64({text.begin(), text.end()}); }

}  // namespace

TEST_CASE("base64 gives the test vectors of RFC 4648") {
  CHECK(base64_of("") == "");
  CHECK(base64_of("f") == "Zg==");
  CHECK(base64_of("fo") == "Zm8=");
  CHECK(base64_of("foo") == "Zm9v");
  CHECK(base64_of("foob") == "Zm9vYg==");
  CHECK(base64_of("fooba") == "Zm9vYmE=");
  CHECK(base64_of("foobar") == "Zm9vYmFy");
}

TEST_CASE("a point darkens the pixel that it lies over, y upwards, and no other") {
  const PlotBox box{0.0, 4.0, 0.0, 2.0};
  const RgbImage image =
      density_from_above({{3.5F, 1.5F, 7.0F}, {3.6F, 1.6F, 0.0F}, {0.5F, 0.5F, 0.0F}}, box, 2, 4);
  const auto grey = [&](int row, int column) { return image.pixels[row * 4 + column][0]; };
  CHECK(grey(0, 3) < grey(1, 0));
  CHECK(grey(1, 0) < 255);
  int white = 0;
  for (const auto& pixel : image.pixels) {
    white += pixel[0] == 255 ? 1 : 0;
  }
  CHECK(white == 6);
}

TEST_CASE("points outside the box, not finite or none at all leave the image white") {
  const PlotBox box{0.0, 1.0, 0.0, 1.0};
  const RgbImage image =
      density_from_above({{-0.1F, 0.5F, 0.0F}, {0.5F, 1.1F, 0.0F}, {NAN, 0.5F, 0.0F}}, box, 2, 2);
  for (const auto& pixel : image.pixels) {
    CHECK(pixel[0] == 255);
  }
}

}  // namespace hqslam::tools
