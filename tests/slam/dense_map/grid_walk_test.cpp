#include "dense_map/grid_walk.h"

#include "slam/random_unit.h"

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

TEST_CASE("the cells cover the section without gaps, each holding its part") {
  std::mt19937 generator(5);
  for (int beam = 0; beam < 200; ++beam) {
    BeamSection section;
    section.origin_m = 5.0 * random_vector(generator);
    section.direction = random_vector(generator).normalized();
    section.begin_m = 0.3;
    section.end_m = 4.0;
    double at_m = section.begin_m;
    for (const Visit& visit : visits_of(section, 0.1)) {
      REQUIRE(visit.begin_m == at_m);
      at_m = visit.end_m;
      for (const double border_m : {visit.begin_m, visit.end_m}) {
        const Eigen::Vector3d within =
            (section.origin_m + border_m * section.direction) / 0.1 - visit.cell.cast<double>();
        REQUIRE(within.minCoeff() > -1e-9);
        REQUIRE(within.maxCoeff() < 1.0 + 1e-9);
      }
    }
    CHECK(at_m == section.end_m);
  }
}
