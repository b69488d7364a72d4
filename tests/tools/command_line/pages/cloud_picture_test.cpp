#include "report/cloud_picture.h"

#include <doctest/doctest.h>

#include <limits>
#include <string_view>
#include <utility>

namespace hqslam::tools {
namespace {

Trajectory straight_path(int poses) {
  Trajectory path;
  for (int i = 0; i < poses; ++i) {
    StampedPose pose;
    pose.T_map_sensor.translation() = Eigen::Vector3d(i, 0.0, 0.0);
    path.push_back(pose);
  }
  return path;
}

/// Pixels that are not of the background, which is that of an empty picture.
std::vector<int> drawn_pixels(const RgbImage& image, const RgbImage& empty) {
  std::vector<int> drawn;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i] != empty.pixels[i]) drawn.push_back(static_cast<int>(i));
  }
  return drawn;
}

}  // namespace

TEST_CASE("from above a point is where it is: x to the right, y upwards") {
  const Trajectory path = straight_path(1);  // 40 m to each side: 1 pixel per metre
  const RgbImage empty = cloud_from_above({{}, path, 0.1}, 80, 80);
  const std::vector<Eigen::Vector3f> points_m = {{10.5F, 20.5F, 0.0F}};
  const RgbImage image = cloud_from_above({points_m, path, 0.1}, 80, 80);
  const std::vector<int> drawn = drawn_pixels(image, empty);
  REQUIRE(drawn.size() == 1);
  CHECK(drawn[0] / 80 == 19);
  CHECK(drawn[0] % 80 == 50);
}

TEST_CASE(
    "in perspective what is ahead of the sensor is in the middle, what is behind is not seen") {
  const Trajectory path = straight_path(30);  // seen from behind x = 10
  const RgbImage empty = cloud_in_perspective({{}, path, 0.1}, 90, 160);
  const std::vector<Eigen::Vector3f> ahead_m = {{20.0F, 0.0F, -1.8F}};
  const std::vector<int> drawn =
      drawn_pixels(cloud_in_perspective({ahead_m, path, 0.1}, 90, 160), empty);
  REQUIRE_FALSE(drawn.empty());
  for (const int pixel : drawn) CHECK(std::abs(pixel % 160 - 80) <= 1);
  const std::vector<Eigen::Vector3f> left_m = {{20.0F, 5.0F, -1.8F}};
  for (const int pixel : drawn_pixels(cloud_in_perspective({left_m, path, 0.1}, 90, 160), empty)) {
    CHECK(pixel % 160 < 70);
  }
  const std::vector<Eigen::Vector3f> behind_m = {{-60.0F, 0.0F, 0.0F}};
  CHECK(drawn_pixels(cloud_in_perspective({behind_m, path, 0.1}, 90, 160), empty).empty());
}

TEST_CASE("the nearer of two points hides the other, whatever their order") {
  const Trajectory path = straight_path(1);
  const std::vector<Eigen::Vector3f> low_first = {{0.5F, 0.5F, 0.0F}, {0.5F, 0.5F, 9.0F}};
  const std::vector<Eigen::Vector3f> high_first = {low_first[1], low_first[0]};
  CHECK(cloud_from_above({low_first, path, 0.1}, 80, 80).pixels ==
        cloud_from_above({high_first, path, 0.1}, 80, 80).pixels);
}

TEST_CASE("no path and points that are not finite give a picture all the same") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points_m = {{kNan, 0.0F, 0.0F}, {1e30F, -1e30F, 0.0F}};
  CHECK(cloud_from_above({points_m, {}, 0.1}, 20, 30).pixels.size() == 600);
  CHECK(cloud_in_perspective({points_m, {}, 0.1}, 20, 30).pixels.size() == 600);
  CHECK(cloud_in_perspective({points_m, straight_path(3), 0.1}, 20, 30).pixels.size() == 600);
}

TEST_CASE("base64 gives the test vectors of RFC 4648") {
  using Vector = std::pair<std::string_view, std::string_view>;
  for (const auto& [text, encoded] :
       {Vector{"", ""}, Vector{"f", "Zg=="}, Vector{"fo", "Zm8="}, Vector{"foo", "Zm9v"},
        Vector{"foob", "Zm9vYg=="}, Vector{"fooba", "Zm9vYmE="}, Vector{"foobar", "Zm9vYmFy"}}) {
    CHECK(base64({text.begin(), text.end()}) == encoded);
  }
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
