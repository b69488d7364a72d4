#include "pages/point_blocks.h"

#include "testing.h"

namespace hqslam::tools {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// Evenly on a wavy ground of this many metres on each side.
Points ground(std::size_t points, float side_m) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> along_m(0.0F, side_m);
  Points result;
  for (std::size_t i = 0; i < points; ++i) {
    const float x = along_m(random);
    result.emplace_back(x - 300.0F, along_m(random) + 1000.0F, 2.0F * std::sin(0.1F * x));
  }
  return result;
}

Eigen::Vector3i steps_of(std::uint32_t point) {
  return Eigen::Vector3i(point & 511U, point >> 9U & 511U, point >> 18U & 511U);
}

unsigned share_of(std::uint32_t point) { return point >> 27U; }

/// What a page makes of the blocks.
Points unpacked(const PointBlocks& blocks) {
  Points result;
  std::size_t at = 0;
  for (const PointBlocks::Block& block : blocks.blocks) {
    for (std::uint32_t i = 0; i < block.ends[0]; ++i, ++at) {
      const Eigen::Vector3i steps = 512 * block.corner + steps_of(blocks.points.at(at));
      result.push_back(
          (blocks.origin_m + blocks.step_m * (steps.cast<double>().array() + 0.5).matrix())
              .cast<float>());
    }
  }
  CHECK(at == blocks.points.size());
  return result;
}

double farthest_off_m(const Points& from_m, const Points& to_m) {
  float farthest_m = 0.0F;
  for (const Eigen::Vector3f& point_m : from_m) {
    float nearest_m = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& other_m : to_m) {
      nearest_m = std::min(nearest_m, (other_m - point_m).cwiseAbs().maxCoeff());
    }
    farthest_m = std::max(farthest_m, nearest_m);
  }
  return farthest_m;
}

}  // namespace

TEST_CASE("no coordinate of a point is off by more than half a step, thinned or not") {
  const Points points_m = ground(2000, 40.0F);
  for (const std::size_t most : {std::size_t{5000}, std::size_t{500}}) {
    const PointBlocks blocks = point_blocks(points_m, {}, most);
    const Points shown_m = unpacked(blocks);
    CHECK(shown_m.size() <= most);
    const double half_step_m = 0.5 * blocks.step_m + 2e-4;  // of float coordinates of 1000 m
    CHECK(farthest_off_m(shown_m, points_m) < half_step_m);
    if (most > points_m.size()) {
      CHECK(blocks.step_m == PointBlocks::kLeastStep_m);
      CHECK(farthest_off_m(points_m, shown_m) < half_step_m);
    }
  }
}

TEST_CASE("a large cloud is thinned to its budget, and evenly") {
  constexpr std::size_t kMost = 20'000;
  const PointBlocks blocks = point_blocks(ground(200'000, 90.0F), {}, kMost);
  CHECK(blocks.points.size() <= kMost);
  CHECK(blocks.points.size() > kMost * 9 / 10);
  const double apart_m = 90.0 / std::sqrt(static_cast<double>(blocks.points.size()));
  CHECK(blocks.spacing_m == doctest::Approx(1.2 * apart_m).epsilon(0.1));
  std::array<int, 9> ninths{};
  for (const Eigen::Vector3f& p : unpacked(blocks)) {
    const auto third = [](float along_m) {
      return std::clamp(static_cast<std::size_t>(along_m / 30.0F), std::size_t{0}, std::size_t{2});
    };
    ++ninths[3 * third(p.x() + 300.0F) + third(p.y() - 1000.0F)];
  }
  for (const int points : ninths) CHECK(points == doctest::Approx(kMost / 9.0).epsilon(0.1));
}

TEST_CASE("the spacing of points shrinks with the root of their density, without steps") {
  double before_m = point_blocks(ground(20'000, 30.0F), {}, 100'000).spacing_m;
  for (const std::size_t points : {24'000, 28'800, 34'560, 41'472}) {
    const double spacing_m = point_blocks(ground(points, 30.0F), {}, 100'000).spacing_m;
    CHECK(spacing_m == doctest::Approx(before_m / std::sqrt(1.2)).epsilon(0.06));
    before_m = spacing_m;
  }
}

TEST_CASE("the first points of a block are one per voxel of their level") {
  const PointBlocks blocks = point_blocks(ground(20'000, 30.0F), {}, 15'000);
  std::size_t first = 0;
  for (const PointBlocks::Block& block : blocks.blocks) {
    for (int level = 0; level < PointBlocks::kLevels; ++level) {
      std::set<std::tuple<int, int, int>> all;
      std::set<std::tuple<int, int, int>> shown;
      for (std::uint32_t i = 0; i < block.ends[0]; ++i) {
        const Eigen::Vector3i steps = steps_of(blocks.points[first + i]);
        const std::tuple voxel(steps.x() >> level, steps.y() >> level, steps.z() >> level);
        all.insert(voxel);
        if (i < block.ends[static_cast<std::size_t>(level)]) shown.insert(voxel);
      }
      CHECK(shown.size() == block.ends[static_cast<std::size_t>(level)]);
      CHECK(shown == all);
    }
    first += block.ends[0];
  }
}

TEST_CASE("a confidence stays as it is within a 62nd, and of one place the surest point") {
  const Points points_m = {{0.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}, {5.001F, 0.0F, 0.0F}};
  const PointBlocks blocks = point_blocks(points_m, {0.4F, 0.2F, 2.0F}, 10);
  REQUIRE(blocks.points.size() == 2);
  CHECK(share_of(blocks.points[0]) / 31.0 == doctest::Approx(0.4).epsilon(0.05));
  CHECK(share_of(blocks.points[1]) == PointBlocks::kMostShare);
  CHECK(share_of(point_blocks({{1.0F, 2.0F, 3.0F}}, {}, 10).points[0]) == PointBlocks::kMostShare);
}

TEST_CASE("brightness goes with its point, in 255 steps, and of one place the brighter one") {
  const Points points_m = {{5.0F, 0.0F, 0.0F}, {5.001F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}};
  const PointBlocks blocks = point_blocks(points_m, {}, 10, {0.2F, 0.4F, std::nanf("")});
  CHECK(blocks.brightness == std::vector<std::uint8_t>{0, 102});
  CHECK(point_blocks(points_m, {}, 10).brightness.empty());
}

TEST_CASE("points that are not finite, or far away, do no harm") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  CHECK(point_blocks({}, {}, 10).points.empty());
  CHECK(point_blocks({{nan, 0.0F, 0.0F}, {0.0F, infinite, 0.0F}}, {}, 10).points.empty());
  CHECK(point_blocks({{nan, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F}}, {}, 10).points.size() == 1);
  CHECK(point_blocks(Points(100, {4.0F, 4.0F, 4.0F}), {}, 10).points.size() == 1);
  const float most = std::numeric_limits<float>::max();
  const PointBlocks far = point_blocks({{-most, 0.0F, 0.0F}, {most, 0.0F, most}}, {nan, 1.0F}, 10);
  CHECK(far.points.size() == 2);
  CHECK(std::isfinite(far.step_m));
}

}  // namespace hqslam::tools
