#include "hqs/beam_parameters.h"

#include "made_images.h"
#include "random_values.h"

namespace hqslam::nn {
namespace {

/// Beams at 10, 8.5, 4 and 3 degrees are measured, with a row in the middle above each.
SensorModel uneven_beams() {
  return beams_at(radians({10.75, 10.0, 9.25, 8.5, 6.25, 4.0, 3.5, 3.0}), 1024);
}
constexpr RowSelection kEveryOther{1, 2};

}  // namespace

TEST_CASE("the place of a row is its way between two beams, their gap and its elevation") {
  const RowPlace inside = row_place(uneven_beams(), kEveryOther, 4);  // 6.25 between 8.5 and 4
  const double g = std::log(4.5 / 1.5);
  const double e = 6.25 / 20.0;
  const double expected[] = {1.0, 0.0, 0.0, 0.0, g, 0.0, e, 0.0, e * e, 0.0, 0.0};
  for (int k = 0; k < kRowPlaces / 2; ++k) {
    CAPTURE(k);
    CHECK(inside[k] == doctest::Approx(expected[k]).epsilon(1e-5));
    CHECK(inside[k + kRowPlaces / 2] == 0.0F);  // it is above its own beam
  }
  // Of four rows the first measured: 9.25, 8.5 and 6.25 degrees are below 10, before 4.
  const RowPlace below = row_place(uneven_beams(), {1, 4}, 2);
  const double v = 2.0 * (0.75 / 6.0) - 1.0;
  CHECK(below[0] == 0.0F);
  CHECK(below[kRowPlaces / 2 + 1] == doctest::Approx(v));
  CHECK(below[kRowPlaces / 2 + 3] == doctest::Approx(v * v * v));
}

TEST_CASE("a row beyond the outermost beams has its distance in gaps in the place of its way") {
  const RowPlace top = row_place(uneven_beams(), kEveryOther, 0);  // 0.75 above 10; gap 1.5
  CHECK(top[1] == 0.0F);
  CHECK(top[4] == doctest::Approx(0.0).epsilon(1e-5));
  CHECK(top[9] == 1.0F);
  CHECK(top[10] == doctest::Approx(0.5));
}

TEST_CASE("an elevation beyond those of training counts as the nearest of them") {
  SensorModel dome = uneven_beams();
  dome.beam_elevation_rad = radians({88.0, 85.0, 60.0, 55.0, 20.0, 15.0, -60.0, -75.0});
  const auto e = [](double elevation_deg) { return doctest::Approx(elevation_deg / 20.0); };
  CHECK(row_place(dome, kEveryOther, 2)[6] == e(45.0));
  CHECK(row_place(dome, kEveryOther, 2)[8] == doctest::Approx(2.25 * 2.25));
  CHECK(row_place(dome, kEveryOther, 4)[6] == e(20.0));
  CHECK(row_place(dome, kEveryOther, 6)[6] == e(-48.5));
  CHECK(beam_place(dome, kEveryOther, 0)[2] == e(45.0));
  CHECK(beam_place(dome, kEveryOther, 3)[2] == e(-48.5));
}

TEST_CASE("the place of a beam has the gaps on both sides, at the ends that of the other side") {
  const BeamPlace first = beam_place(uneven_beams(), kEveryOther, 0);
  const auto log_gap = [](double gap_deg) { return std::log(gap_deg / 1.5); };
  CHECK(first[0] == doctest::Approx(log_gap(1.5)));
  CHECK(first[1] == doctest::Approx(log_gap(1.5)));
  CHECK(first[4] == 1.0F);
  CHECK(first[5] == 0.0F);
  const BeamPlace third = beam_place(uneven_beams(), kEveryOther, 2);
  CHECK(third[0] == doctest::Approx(log_gap(4.5)));
  CHECK(third[1] == doctest::Approx(log_gap(1.0)));
  CHECK(third[2] == doctest::Approx(0.2));
  CHECK(third[6] == doctest::Approx(std::log(360.0 / 1024.0 / 0.35)).epsilon(1e-4));
}

TEST_CASE("gradients go the way of the parameters back: the map and its adjoint agree") {
  const std::vector<ParameterShape> of_graph = {{"encoder.0.weight", {3, 12, 3, 3}},
                                                {"encoder.0.row_bias", {3, 4}},
                                                {"head.weight", {4, 7 * 4, 3}},
                                                {"head.bias", {4, 7 * 4}}};
  const BeamParameters beams(uneven_beams(), kEveryOther, {2, 4}, of_graph);
  CHECK(beams.shapes()[1].name == "encoder.0.beam_bias");
  CHECK(beams.shapes()[2].shape == std::vector<std::int64_t>{kRowPlaces, 28, 3});
  const std::vector<float> shared = random_values(1, elements(beams.shapes()));
  const std::vector<float> d_graph = random_values(2, elements(of_graph));
  const std::vector<float> graph = beams.of_graph(shared);
  std::vector<float> d_shared(shared.size(), 0.0F);
  beams.add_gradient(d_graph, d_shared);
  double forward = 0.0;
  double back = 0.0;
  for (std::size_t i = 0; i < graph.size(); ++i) forward += graph[i] * d_graph[i];
  for (std::size_t i = 0; i < shared.size(); ++i) back += shared[i] * d_shared[i];
  CHECK(forward == doctest::Approx(back).epsilon(1e-4));
}

}  // namespace hqslam::nn
