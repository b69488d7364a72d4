#include <algorithm>

#include "block_contents.h"

namespace hqslam::sim {

namespace {

constexpr Surface kPoleMetal{Material::kMetal, 110};

/// Upright, from one height over the terrain to another.
void add_board(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double low_m,
               double high_m, Surface surface) {
  const Layout& layout = city.layout;
  add_quad(city.fixed, layout.ground(from_m, low_m), layout.ground(to_m, low_m),
           layout.ground(to_m, high_m), layout.ground(from_m, high_m), surface);
}

void add_post(City& city, const Eigen::Vector2d& at_m, double foot_m, double radius_m, int sides,
              Surface surface) {
  add_column(city.fixed, city.layout.ground(at_m, foot_m), city.layout.ground(at_m, 1.3), radius_m,
             radius_m, sides, surface);
}

}  // namespace

void add_lamp(TriangleMesh& mesh, const Eigen::Isometry3d& frame) {
  constexpr double kHeight_m = 7.0;
  const Part pole{mesh, frame, kPoleMetal};
  pole.column({0.0, 0.0, -0.4}, {0.0, 0.0, kHeight_m}, 0.09, 0.06, 8);
  pole.column({0.0, 0.0, kHeight_m - 0.1}, {0.0, -1.8, kHeight_m + 0.2}, 0.045, 0.045, 5);
  pole.box({-0.15, -2.3, kHeight_m + 0.12}, {0.15, -1.7, kHeight_m + 0.28});
}

void add_traffic_sign(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double height_m = random.uniform(2.1, 2.6);
  const double half_m = random.uniform(0.25, 0.4);
  Part{mesh, frame, kPoleMetal}.column({0.0, 0.0, -0.3}, {0.0, 0.0, height_m + half_m}, 0.035,
                                       0.035, 6);
  add_box(mesh, frame, {-0.05, -half_m, height_m - half_m}, {-0.035, half_m, height_m + half_m},
          {Material::kRetroreflector, 128});
}

void add_traffic_light(TriangleMesh& mesh, const Eigen::Isometry3d& frame) {
  const Part pole{mesh, frame, kPoleMetal};
  pole.column({0.0, 0.0, -0.3}, {0.0, 0.0, 5.6}, 0.09, 0.08, 8);
  pole.column({0.0, 0.0, 5.5}, {0.0, -3.6, 5.7}, 0.06, 0.05, 6);
  const Part lights{mesh, frame, {Material::kMetal, 20}};
  lights.box({-0.18, -3.6 - 0.15, 5.0}, {0.12, -3.6 + 0.15, 5.0 + 0.9});
  lights.box({-0.18, -0.25 - 0.15, 2.7}, {0.12, -0.25 + 0.15, 2.7 + 0.9});
}

void add_bench(TriangleMesh& mesh, const Eigen::Isometry3d& frame) {
  const Part wood{mesh, frame, {Material::kWood, 120}};
  wood.box({-0.9, -0.2, 0.42}, {0.9, 0.25, 0.47});
  wood.box({-0.9, 0.25, 0.55}, {0.9, 0.3, 0.9});
  const Part legs{mesh, frame, kPoleMetal};
  for (const double x_m : {-0.75, 0.7}) {
    legs.box({x_m, -0.2, -0.2}, {x_m + 0.06, 0.25, 0.42});
    legs.box({x_m, 0.24, 0.42}, {x_m + 0.06, 0.3, 0.9});
  }
}

void add_bin(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double radius_m = random.uniform(0.22, 0.35);
  const Part metal{mesh, frame, {Material::kMetal, random.shade()}};
  metal.column({0.0, 0.0, -0.2}, {0.0, 0.0, random.uniform(0.8, 1.15)}, radius_m, radius_m, 9);
}

void add_hedge(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
               double height_m, Random& random) {
  constexpr double kStep_m = 0.5;
  constexpr double kHalfWidth_m = 0.45;
  const Eigen::Vector2d line_m = to_m - from_m;
  const Eigen::Vector2d across = Eigen::Vector2d(-line_m.y(), line_m.x()).normalized();
  // The cross section: up one side, over the top, down the other.
  const int levels = steps(height_m, kStep_m);
  const int columns = 2 * levels + 3;
  const int rows = steps(line_m.norm(), kStep_m) + 1;
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row) {
    const Eigen::Vector2d at = from_m + line_m * (static_cast<double>(row) / (rows - 1));
    for (int column = 0; column < columns; ++column) {
      const int level = std::min({column, columns - 1 - column, levels});
      const double side = std::clamp(column - levels - 1, -1, 1);
      const double bulge_m = 0.1 * random.uniform(-1.0, 1.0);
      const Eigen::Vector2d sheet = at + side * (kHalfWidth_m + bulge_m) * across;
      const double z_m = height_m * level / levels + (level > 0 ? 0.08 * random.normal() : -0.2);
      points.push_back(city.layout.ground(sheet, kKerbHeight_m + z_m));
    }
  }
  add_grid(city.fixed, points, rows, columns, {Material::kFoliage, 90});
}

void add_picket_fence(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                      Random& random) {
  const Surface wood{Material::kWood, random.shade()};
  const double length_m = (to_m - from_m).norm();
  const Eigen::Vector2d along = (to_m - from_m) / length_m;
  const int pickets = steps(length_m, 0.19);
  for (int picket = 0; picket < pickets; ++picket) {
    const Eigen::Vector2d a = from_m + along * (picket * length_m / pickets);
    add_board(city, a, a + 0.09 * along, 0.1, 1.15, wood);
  }
  const int rails = steps(length_m, 2.5);
  for (int rail = 0; rail < rails; ++rail) {
    const Eigen::Vector2d a = from_m + along * (rail * length_m / rails);
    const Eigen::Vector2d b = from_m + along * ((rail + 1) * length_m / rails);
    for (const double z_m : {0.4, 0.95}) add_board(city, a, b, z_m, z_m + 0.08, wood);
    add_post(city, a, 0.0, 0.05, 5, wood);
  }
}

void add_rail_fence(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  const Surface wood{Material::kWood, 100};
  const int spans = steps((to_m - from_m).norm(), 3.5);
  for (int span = 0; span <= spans; ++span) {
    const Eigen::Vector2d here = from_m + (to_m - from_m) * (static_cast<double>(span) / spans);
    add_post(city, here, -0.2, 0.07, 6, wood);
    if (span == spans) return;
    const Eigen::Vector2d next = from_m + (to_m - from_m) * ((span + 1.0) / spans);
    for (const double z_m : {0.55, 1.1}) add_board(city, here, next, z_m, z_m + 0.1, wood);
  }
}

void add_garden_wall(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                     double height_m, Surface surface) {
  const double length_m = (to_m - from_m).norm();
  const Eigen::Vector2d along = (to_m - from_m) / length_m;
  const Eigen::Vector2d across = 0.13 * Eigen::Vector2d(-along.y(), along.x());
  const int rows = steps(length_m, 3.0) + 1;
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row) {
    const Eigen::Vector2d at = from_m + (to_m - from_m) * (static_cast<double>(row) / (rows - 1));
    points.push_back(city.layout.ground(at - across, -0.2));
    points.push_back(city.layout.ground(at - across, height_m));
    points.push_back(city.layout.ground(at + across, height_m));
    points.push_back(city.layout.ground(at + across, -0.2));
  }
  add_grid(city.fixed, points, rows, 4, surface);
}

void add_wire(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  constexpr int kSpans = 4;
  const auto at = [&](int span) {
    const double fraction = static_cast<double>(span) / kSpans;
    Eigen::Vector3d point = from + fraction * (to - from);
    point.z() -= 0.03 * (to - from).norm() * 4.0 * fraction * (1.0 - fraction);
    return point;
  };
  for (int span = 0; span < kSpans; ++span) {
    add_column(mesh, at(span), at(span + 1), 0.02, 0.02, 3, {Material::kRubber, 200});
  }
}

}  // namespace hqslam::sim
