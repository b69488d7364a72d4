#include "golden.h"
#include "hqs/prior_backward.h"

namespace hqslam::nn {
namespace {

constexpr TileSize kTile{2, 2};

Tensor of(const Golden& golden, const std::string& name, int channels) {
  return tensor_of(golden.values("selection." + name), channels, 2, 20);
}

CandidatesOf rows_of(const Candidates& candidates) {
  return [&candidates](int channel, int row) {
    return CandidateRows{candidates.above.row(channel, row), candidates.below.row(channel, row)};
  };
}

struct Selection {
  Candidates candidates;
  Tensor here;
  Tensor scores;
};

/// One tile pixel per channel, 20 columns; every candidate has a range of its own.
Selection with_scores(float above, float below, float here, float nothing, float correction) {
  const Tensor image(1, 1, 20, ColumnPadding::kCircular);
  Selection s{{image, image}, image, Tensor(5, 1, 20, ColumnPadding::kCircular)};
  const float values[5] = {above, below, here, nothing, correction};
  for (int x = 0; x < 20; ++x) {
    for (int group = 0; group < 5; ++group) s.scores.at(group, 0, x) = values[group];
    s.candidates.above.at(0, 0, x) = 1.0F;
    s.candidates.below.at(0, 0, x) = 2.0F;
    s.here.at(0, 0, x) = 4.0F;
  }
  return s;
}

void select_all(const Candidates& candidates, const Tensor& h, TileSize tile,
                InstructionSet instruction_set, Tensor& scores, Tensor& z) {
  for (int row = 0; row < z.rows(); ++row) {
    select_row(rows_of(candidates), h, tile, instruction_set, row, scores.row(0, row),
               scores.channel_stride(), z);
  }
}

float selected(Selection s, InstructionSet instruction_set) {
  Tensor z = s.here;
  select_all(s.candidates, s.here, {}, instruction_set, s.scores, z);
  return z.at(0, 0, 19);
}

}  // namespace

TEST_CASE("selection and its gradients equal PyTorch's with every instruction set") {
  const Golden golden("layers");
  const Candidates candidates{of(golden, "above", 4), of(golden, "below", 4)};
  const Tensor here = of(golden, "here", 4);
  const Tensor d_z = of(golden, "d_output", 4);
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    Tensor scores = of(golden, "scores", 20);
    Tensor z = here;
    select_all(candidates, here, kTile, instruction_set, scores, z);
    CHECK(relative_error(z, golden.values("selection.output")) < 1e-5);
    std::vector<float> weights = values_of(scores);
    weights.resize(weights.size() / 5 * 4);
    CHECK(relative_error(weights, golden.values("selection.weights")) < 1e-5);
    Tensor d_scores = scores;
    Tensor d_here = here;
    select_backward(rows_of(candidates), here, kTile, instruction_set, 0, scores, d_z, d_scores,
                    d_here);
    CHECK(relative_error(d_scores, golden.values("selection.d_scores")) < 1e-5);
    CHECK(relative_error(d_here, golden.values("selection.d_here")) < 1e-5);
    CHECK(d_scores.at(19, 1, -1) == d_scores.at(19, 1, 19));
    Tensor in_place = d_z;  // the denoiser lets d loss / d H take the place of d loss / d Z
    select_backward(rows_of(candidates), here, kTile, instruction_set, 0, scores, in_place,
                    d_scores, in_place);
    CHECK(same_bits(in_place, d_here));
    CHECK(relative_error(d_scores, golden.values("selection.d_scores")) < 1e-5);
  }
}

TEST_CASE("a clear score chooses its candidate, and the correction is added") {
  for (const InstructionSet any : available_instruction_sets()) {
    CAPTURE(name(any));
    CHECK(selected(with_scores(50, 0, 0, 0, 0), any) == 1.0F);
    CHECK(selected(with_scores(0, 50, 0, 0, 0), any) == 2.0F);
    CHECK(selected(with_scores(0, 0, 50, 0, 0), any) == 4.0F);
    CHECK(selected(with_scores(0, 0, 0, 50, 0), any) == doctest::Approx(0.0));
    CHECK(selected(with_scores(0, 50, 0, 0, 0.5F), any) == 2.5F);
    CHECK(selected(with_scores(1, 1, 1, 1, 0), any) == doctest::Approx(7.0 / 4.0));
    CHECK(selected(with_scores(1e6F, 0, 0, -1e6F, 0), any) == 1.0F);  // no overflow
  }
}

TEST_CASE("the softmax is exact to 1e-6 over the whole range of scores") {
  for (const InstructionSet any : available_instruction_sets()) {
    CAPTURE(name(any));
    for (int step = -400; step <= 400; ++step) {
      const double score = step * 0.05;
      Selection s = with_scores(static_cast<float>(score), 0.0F, -1e4F, -1e4F, 0.0F);
      Tensor z = s.here;
      select_all(s.candidates, s.here, {}, any, s.scores, z);
      const double expected = 1.0 / (1.0 + std::exp(-4.0 * static_cast<float>(score)));
      REQUIRE(s.scores.at(0, 0, 3) == doctest::Approx(expected).epsilon(1e-6));
    }
  }
}

}  // namespace hqslam::nn
