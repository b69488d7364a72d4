#include "side_by_side/side_by_side.h"

#include <omp.h>

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("every job is done once, by threads with the OpenMP threads that they may have") {
  std::array<std::atomic<int>, 50> done{};
  std::atomic<int> threads = 0;
  CHECK(side_by_side(done.size(), 4, 3, [&](std::size_t job, const std::atomic<bool>& stopped) {
    ++done[job];
    threads += omp_get_max_threads();
    return !stopped;
  }));
  for (const std::atomic<int>& times : done) CHECK(times == 1);
  CHECK(threads == 3 * 50);
}

TEST_CASE("nothing is begun after a job was interrupted") {
  std::atomic<int> begun = 0;
  CHECK_FALSE(side_by_side(100, 1, 1, [&](std::size_t job, const std::atomic<bool>&) {
    ++begun;
    return job != 2;
  }));
  CHECK(begun == 3);
}

TEST_CASE("what a job throws is thrown, once the others know and have stopped") {
  std::atomic<bool> reported = false;
  CHECK_THROWS_WITH_AS(side_by_side(2, 2, 1,
                                    [&](std::size_t job, const std::atomic<bool>& stopped) -> bool {
                                      if (job == 1) throw std::runtime_error("no disk");
                                      while (!stopped) std::this_thread::yield();
                                      reported = true;
                                      return false;
                                    }),
                       "no disk", std::runtime_error);
  CHECK(reported);
}

}  // namespace hqslam::tools
