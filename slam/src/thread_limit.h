#pragma once

#include <omp.h>

namespace hqslam::slam {

/// Sets the number of threads of the parallel regions that the calling thread begins during the
/// lifetime of the object; other threads are not affected.
class ThreadLimit {
 public:
  /// 0: unchanged.
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
