#include "dense_map/voxel_votes.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

const Eigen::Vector3d kMiddle(0.5, 0.5, 0.5);

/// A voxel with a computed point of each of these scans.
Voxel voted_by(std::initializer_list<std::uint32_t> scans, float confidence) {
  Voxel voxel;
  for (const std::uint32_t scan : scans) vote_for(voxel, kMiddle, computed_vote(confidence), scan);
  return voxel;
}

}  // namespace

TEST_CASE("odds by hand: votes of scans, times neighbours, over passes") {
  // 0.5 is odds of 1; alone they are halved.
  CHECK(confidence_of(voted_by({1}, 0.5F), 0.0) == doctest::Approx(1.0 / 3.0).epsilon(1e-3));
  CHECK(confidence_of(voted_by({1, 2}, 0.5F), 0.0) == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(confidence_of(voted_by({1}, 0.5F), 1.0) == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(confidence_of(voted_by({1}, 0.8F), 3.0) == doctest::Approx(8.0 / 9.0).epsilon(1e-3));
  Voxel measured;
  vote_for(measured, kMiddle, measured_vote(), 1);
  CHECK(confidence_of(measured, 0.0) == doctest::Approx(9.5 / 10.5).epsilon(1e-3));
  measured.times_seen_through = 2;
  CHECK(confidence_of(measured, 0.0) == doctest::Approx(9.5 / 9.0 / (1.0 + 9.5 / 9.0)));
}

TEST_CASE("a scan has one vote, that of its most confident point, in any order") {
  Voxel rising;
  vote_for(rising, kMiddle, computed_vote(0.3F), 7);
  vote_for(rising, kMiddle, computed_vote(0.9F), 7);
  Voxel falling;
  vote_for(falling, kMiddle, computed_vote(0.9F), 7);
  vote_for(falling, kMiddle, computed_vote(0.3F), 7);
  CHECK(rising.times_seen == 1);
  CHECK(rising.odds_sum == falling.odds_sum);
  CHECK(rising.odds_sum == voted_by({1}, 0.9F).odds_sum);
}

TEST_CASE("a computed point of little or no confidence has no vote") {
  CHECK(computed_vote(0.05F).odds == 0);
  CHECK(computed_vote(0.0F).odds == 0);
  CHECK(computed_vote(std::numeric_limits<float>::quiet_NaN()).odds == 0);
  CHECK(computed_vote(0.2F).odds > 0);
  CHECK(computed_vote(1e9F).odds == computed_vote(0.98F).odds);
}

TEST_CASE("measured points alone decide the position, before and after computed ones") {
  for (const bool measured_first : {true, false}) {
    Voxel voxel;
    if (measured_first) vote_for(voxel, {0.25, 0.25, 0.25}, measured_vote(), 1);
    vote_for(voxel, {0.75, 0.75, 0.75}, computed_vote(0.9F), 2);
    if (!measured_first) vote_for(voxel, {0.25, 0.25, 0.25}, measured_vote(), 1);
    vote_for(voxel, {0.35, 0.25, 0.25}, measured_vote(), 3);
    CHECK(mean_place(voxel).isApprox(Eigen::Vector3d(0.3, 0.25, 0.25), 3e-3));
    CHECK(voxel.times_seen == 3);
    CHECK(voxel.times_measured == 2);
  }
  Voxel computed;  // of which each counts by its confidence
  vote_for(computed, {0.2, 0.5, 0.5}, computed_vote(0.75F), 1);
  vote_for(computed, {0.6, 0.5, 0.5}, computed_vote(0.25F), 2);
  CHECK(mean_place(computed).x() == doctest::Approx(0.3).epsilon(5e-3));
}

TEST_CASE("a neighbour supports fully where measured, by a quarter where computed, or not at all") {
  Voxel voxel = voted_by({1}, 0.5F);
  CHECK(support_of(voxel) == 0.25);
  voxel.times_measured = 1;
  CHECK(support_of(voxel) == 1.0);
  voxel.times_seen_through = 1;
  CHECK(support_of(voxel) == 1.0);
  voxel.times_seen_through = 2;
  CHECK(support_of(voxel) == 0.0);
}
