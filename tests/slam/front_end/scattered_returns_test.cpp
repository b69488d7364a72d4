#include "front_end/scattered_returns.h"

#include "slam/village.h"

namespace {

/// A cloud of a wall around the sensor, 5 m away.
OrganizedCloud wall(int rows = 16, int columns = 360) {
  OrganizedCloud cloud(rows, columns);
  std::ranges::fill(cloud.range_m, 5.0F);
  std::ranges::fill(cloud.points_m, Eigen::Vector3f(5.0F, 0.0F, 0.0F));
  return cloud;
}

void set(OrganizedCloud& cloud, int row, int column, float range_m) {
  cloud.range_m[cloud.index(row, column)] = range_m;
  cloud.points_m[cloud.index(row, column)] = {range_m, 0.0F, 0.0F};
}

/// Echoes from 1 to 4 m in a share of the pixels, at random.
std::vector<std::uint8_t> add_echoes(OrganizedCloud& cloud, double share) {
  std::mt19937 generator(5);
  const auto random = [&] { return static_cast<double>(generator() % 100001) / 100000.0; };
  std::vector<std::uint8_t> is_echo(cloud.range_m.size(), 0);
  for (std::size_t pixel = 0; pixel < is_echo.size(); ++pixel) {
    if (random() >= share) continue;
    is_echo[pixel] = 1;
    cloud.range_m[pixel] = static_cast<float>(1.0 + 3.0 * random());
  }
  return is_echo;
}

}  // namespace

TEST_CASE("a scan in clear air stays as it is") {
  CHECK_FALSE(slam::without_scattered(wall()));
  for (double x_m = 0.0; x_m < 60.0; x_m += 7.0) {
    CHECK_FALSE(slam::without_scattered(street(31).scan(yard_pose(x_m, 0.0, 0.0))));
  }
  CHECK_FALSE(slam::without_scattered(OrganizedCloud(16, 360)));  // nothing at all
  CHECK_FALSE(slam::without_scattered(OrganizedCloud()));
}

TEST_CASE("of the echoes of fog a fiftieth stays, of the wall behind nearly all") {
  OrganizedCloud cloud = wall();
  const std::vector<std::uint8_t> is_echo = add_echoes(cloud, 0.2);
  const OrganizedCloud clear = slam::without_scattered(cloud).value();
  std::array<double, 2> before = {0.0, 0.0};
  std::array<double, 2> left = {0.0, 0.0};
  for (std::size_t pixel = 0; pixel < is_echo.size(); ++pixel) {
    ++before[is_echo[pixel]];
    left[is_echo[pixel]] += clear.range_m[pixel] > 0.0F;
    if (!(clear.range_m[pixel] > 0.0F)) CHECK(clear.points_m[pixel].isZero());
  }
  CHECK(left[1] < 0.02 * before[1]);
  CHECK(left[0] > 0.98 * before[0]);
}

TEST_CASE("what stands alone behind the fog is kept") {
  OrganizedCloud cloud = wall();
  add_echoes(cloud, 0.3);
  set(cloud, 8, 100, 30.0F);
  set(cloud, 8, 200, 9.0F);
  const OrganizedCloud clear = slam::without_scattered(cloud).value();
  CHECK(clear.range_m[clear.index(8, 100)] == 30.0F);
  CHECK(clear.range_m[clear.index(8, 200)] == 0.0F);
}

TEST_CASE("columns wrap around") {
  OrganizedCloud cloud = wall(1, 200);
  for (int column = 0; column < 200; ++column) set(cloud, 0, column, column % 8 < 2 ? 5.0F : 0.0F);
  for (int column = 50; column < 150; column += 2)
    set(cloud, 0, column, 1.0F + 0.5F * static_cast<float>(column % 7));
  for (int column : {198, 199, 0, 1}) set(cloud, 0, column, 3.0F);
  const OrganizedCloud clear = slam::without_scattered(cloud).value();
  for (int column : {198, 199, 0, 1}) CHECK(clear.range_m[clear.index(0, column)] == 3.0F);
}
