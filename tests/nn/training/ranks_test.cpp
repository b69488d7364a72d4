#include "hqslam/nn/training/ranks.h"

#include <doctest/doctest.h>

#include <array>
#include <atomic>

#include "thread_ranks.h"

namespace hqslam {

TEST_CASE("one alone is rank 0 of 1, and has what it brings") {
  Ranks alone;
  CHECK(alone.rank() == 0);
  CHECK(alone.count() == 1);
  std::array<double, 2> values = {1.5, -2.0};
  alone.gather(std::span<double>(values));
  CHECK(values == std::array<double, 2>{1.5, -2.0});
  CHECK(alone.any(true));
  CHECK_FALSE(alone.any(false));
  int done = 0;
  alone.rank_0_first([&] { ++done; });
  CHECK(done == 1);
}

TEST_CASE("every rank gets the shares of all in the order of the ranks") {
  std::array<std::array<float, 6>, 3> got{};
  test::on_ranks(3, [&](Ranks& ranks) {
    std::array<float, 6>& all = got[static_cast<std::size_t>(ranks.rank())];
    all[static_cast<std::size_t>(2 * ranks.rank())] = 10.0F + static_cast<float>(ranks.rank());
    all[static_cast<std::size_t>(2 * ranks.rank() + 1)] = 20.0F + static_cast<float>(ranks.rank());
    ranks.gather(std::span<float>(all));
  });
  for (const auto& all : got) {
    CHECK(all == std::array<float, 6>{10.0F, 20.0F, 11.0F, 21.0F, 12.0F, 22.0F});
  }
}

TEST_CASE("a flag of one rank reaches all, and rank 0 goes first") {
  for (const int speaker : {0, 1, 2, 3}) {
    std::atomic<int> heard = 0;
    std::atomic<int> after_rank_0 = 0;
    std::atomic<bool> done_by_rank_0 = false;
    test::on_ranks(3, [&](Ranks& ranks) {
      if (ranks.any(ranks.rank() == speaker)) ++heard;
      ranks.rank_0_first([&] {
        if (ranks.rank() == 0) {
          done_by_rank_0 = true;
        } else if (done_by_rank_0) {
          ++after_rank_0;
        }
      });
      ranks.wait();
    });
    CHECK(heard == (speaker < 3 ? 3 : 0));
    CHECK(after_rank_0 == 2);
  }
}

}  // namespace hqslam
