#include "dense_map/grid_walk.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

struct Visit {
  Eigen::Vector3i cell;
  double begin_m;
  double end_m;
};

std::vector<Visit> visits_of(const BeamSection& beam, double cell_m) {
  std::vector<Visit> visits;
  walk_grid(beam, cell_m, [&](const Eigen::Vector3i& cell, double begin_m, double end_m) {
    visits.push_back({cell, begin_m, end_m});
  });
  return visits;
}

}  // namespace

TEST_CASE("a beam along an axis passes the cells in a row, backwards too") {
  const auto forward = visits_of({{0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 0.0, 2.0}, 1.0);
  REQUIRE(forward.size() == 3);
  CHECK(forward[0].cell == Eigen::Vector3i(0, 0, 0));
  CHECK(forward[0].end_m == doctest::Approx(0.5));
  CHECK(forward[1].end_m == doctest::Approx(1.5));
  CHECK(forward[2].cell == Eigen::Vector3i(2, 0, 0));
  CHECK(forward[2].end_m == doctest::Approx(2.0));
  const auto backward = visits_of({{0.5, 0.5, 0.5}, {0.0, 0.0, -1.0}, 0.0, 1.0}, 1.0);
  REQUIRE(backward.size() == 2);
  CHECK(backward[1].cell == Eigen::Vector3i(0, 0, -1));
}

TEST_CASE("a slanting beam passes cells by their borders, by hand") {
  // x = 0.25 + 0.6 s, y = 0.5 + 0.8 s: y = 1 at 0.625, x = 1 at 1.25, y = 2 at 1.875.
  const auto visits = visits_of({{0.25, 0.5, 0.5}, {0.6, 0.8, 0.0}, 0.0, 1.9}, 1.0);
  REQUIRE(visits.size() == 4);
  CHECK(visits[0].end_m == doctest::Approx(0.625));
  CHECK(visits[1].cell == Eigen::Vector3i(0, 1, 0));
  CHECK(visits[1].end_m == doctest::Approx(1.25));
  CHECK(visits[2].cell == Eigen::Vector3i(1, 1, 0));
  CHECK(visits[3].cell == Eigen::Vector3i(1, 2, 0));
}

TEST_CASE("the cells cover the section without gaps, each holding its part") {
  std::mt19937 generator(5);
  const auto random = [&] { return static_cast<double>(generator() % 20001) / 10000.0 - 1.0; };
  for (int beam = 0; beam < 200; ++beam) {
    BeamSection section;
    section.origin_m = 5.0 * Eigen::Vector3d(random(), random(), random());
    section.direction = Eigen::Vector3d(random(), random(), random()).normalized();
    section.begin_m = 0.3;
    section.end_m = 4.0;
    double at_m = section.begin_m;
    for (const Visit& visit : visits_of(section, 0.1)) {
      REQUIRE(visit.begin_m == at_m);
      at_m = visit.end_m;
      const Eigen::Vector3d middle_m =
          section.origin_m + 0.5 * (visit.begin_m + visit.end_m) * section.direction;
      const Eigen::Vector3d within = middle_m / 0.1 - visit.cell.cast<double>();
      REQUIRE(within.minCoeff() > -1e-9);
      REQUIRE(within.maxCoeff() < 1.0 + 1e-9);
    }
    CHECK(at_m == section.end_m);
  }
}
