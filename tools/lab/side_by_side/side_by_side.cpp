#include "side_by_side/side_by_side.h"

#include <omp.h>

#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hqslam::tools {

bool side_by_side(std::size_t jobs, int workers, int threads_inside, const SideJob& job) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> stopped = false;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    omp_set_num_threads(threads_inside);  // of this thread alone
    try {
      for (std::size_t i = next++; i < jobs && !stopped; i = next++) {
        if (!job(i, stopped)) stopped = true;
      }
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      stopped = true;
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < workers; ++i) threads.emplace_back(work);
  threads.clear();  // joins
  if (failure) std::rethrow_exception(failure);
  return !stopped;
}

}  // namespace hqslam::tools
