#include "hqs/hqs_loop.h"
#include "hqs/u_shaped_prior.h"
#include "hqslam/core/connected_components.h"
#include "hqslam/nn/interpolation.h"
#include "testing.h"

// The numbers of the worked example in nn/hqs/README.md.
namespace hqslam::nn {

TEST_CASE("worked example, start: a pixel a quarter down between 10 m and 14 m") {
  RangeImage measured(2, 16);
  for (int column = 0; column < 16; ++column) {
    measured.at(0, column) = 10.0F;
    measured.at(1, column) = 14.0F;
  }
  const RowSelection rows{3, 4};
  const std::vector<double> elevation_rad = {0.07, 0.06, 0.05, 0.04, 0.03, 0.02, 0.01, 0.0};
  CHECK(interpolate_rows(measured, rows, elevation_rad, Interpolation::kLinear).at(4, 0) ==
        doctest::Approx(11.0));
  CHECK(interpolate_rows(measured, rows, elevation_rad, Interpolation::kInverse).at(4, 0) ==
        doctest::Approx(10.769).epsilon(1e-4));
  CHECK(interpolate_rows(measured, rows, elevation_rad, Interpolation::kNearest).at(4, 0) == 10.0F);
}

TEST_CASE("worked example, data consistency: L = 10, Z = 12, Y = 11, b = 0.1") {
  const float l = 10.0F;
  const float z = 12.0F;
  const float y = 11.0F;
  float h = 0.0F;
  data_consistency_row(&l, &z, &y, 0.1F, 1, &h);
  CHECK(h == doctest::Approx(10.25));  // measured
  data_consistency_row(nullptr, &z, &y, 0.1F, 1, &h);
  CHECK(h == doctest::Approx(11.5));  // not measured
}

TEST_CASE("worked example, memory: 10.5 m through the middle of a pixel of 11.5 m, or beside it") {
  const float m = 10.5F;
  const auto drawn = [&](float weight) {
    const float share = weight / (weight + 1.0F);
    float h = 11.5F;
    recall_row(&m, &share, 1, &h);
    return h;
  };
  CHECK(drawn(4.0F) == doctest::Approx(10.7));
  CHECK(drawn(4.0F * std::exp(-1.0F)) == doctest::Approx(10.90).epsilon(1e-3));
}

TEST_CASE("worked example, selection: above 10 m, below 14 m, here 11.5 m") {
  const Tensor shape(1, 1, 16, ColumnPadding::kCircular);
  Candidates candidates{shape, shape};
  candidates.above.at(0, 0, 0) = 10.0F;
  candidates.below.at(0, 0, 0) = 14.0F;
  Tensor h = shape;
  h.at(0, 0, 0) = 11.5F;
  Tensor scores(kSelectionGroups, 1, 16, ColumnPadding::kCircular);
  scores.at(0, 0, 0) = 1.0F;   // above
  scores.at(3, 0, 0) = -0.5F;  // nothing
  scores.at(4, 0, 0) = 0.02F;  // correction
  Tensor z = shape;
  const CandidatesOf rows = [&](int channel, int row) {
    return CandidateRows{candidates.above.row(channel, row), candidates.below.row(channel, row)};
  };
  select_row(rows, h, {1, 1}, InstructionSet::kPortable, 0, scores.row(0, 0),
             scores.channel_stride(), z);
  CHECK(scores.at(0, 0, 0) == doctest::Approx(0.962).epsilon(1e-3));
  CHECK(scores.at(1, 0, 0) == doctest::Approx(0.0176).epsilon(1e-2));
  CHECK(scores.at(2, 0, 0) == doctest::Approx(0.0176).epsilon(1e-2));
  CHECK(scores.at(3, 0, 0) == doctest::Approx(0.0024).epsilon(2e-2));
  CHECK(z.at(0, 0, 0) == doctest::Approx(10.09).epsilon(1e-3));
}

TEST_CASE("worked example, filter: 10.0 m and 10.2 m connect, 10.2 m and 12.0 m do not") {
  const double alpha_rad = 2.0 * std::numbers::pi / 1024.0;
  const auto angle_deg = [&](double farther_m, double nearer_m) {
    return std::atan2(nearer_m * std::sin(alpha_rad), farther_m - nearer_m * std::cos(alpha_rad)) *
           180.0 / std::numbers::pi;
  };
  CHECK(angle_deg(10.2, 10.0) == doctest::Approx(17.04).epsilon(1e-3));
  CHECK(angle_deg(12.0, 10.2) == doctest::Approx(1.99).epsilon(2e-3));
  const auto connected = [&](float a_m, float b_m) {
    return ComponentLabeler::connected(a_m, b_m, static_cast<float>(std::sin(alpha_rad)),
                                       static_cast<float>(std::cos(alpha_rad)),
                                       std::tan(static_cast<float>(std::numbers::pi) / 12.0F));
  };
  CHECK(connected(10.0F, 10.2F));
  CHECK_FALSE(connected(10.2F, 12.0F));
}

}  // namespace hqslam::nn
