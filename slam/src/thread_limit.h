#pragma once

#include <omp.h>

namespace hqslam::slam {

/// As long as it lives, the parallel regions that the calling thread begins have so many threads;
/// those of other threads are not touched.
class ThreadLimit {
 public:
  /// 0: as many as without it.
  explicit ThreadLimit(int threads) : before_(omp_get_max_threads()) {
    if (threads > 0) omp_set_num_threads(threads);
  }
  ~ThreadLimit() { omp_set_num_threads(before_); }
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  int before_;
};

}  // namespace hqslam::slam
