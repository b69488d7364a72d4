#pragma once

#include <algorithm>
#include <barrier>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "hqslam/nn/training/ranks.h"

namespace hqslam::test {

/// Ranks that are threads of one process.
class ThreadRanks : public Ranks {
 public:
  struct Meeting {
    explicit Meeting(int count) : all_here(count) {}
    std::barrier<> all_here;
    std::mutex mutex;
    std::vector<std::byte> brought;
  };
  ThreadRanks(Meeting& meeting, int rank, int count)
      : meeting_(meeting), rank_(rank), count_(count) {}
  int rank() const override { return rank_; }
  int count() const override { return count_; }

 private:
  void gather_bytes(std::span<std::byte> all) override {
    const std::size_t share = all.size() / static_cast<std::size_t>(count_);
    const std::size_t own = share * static_cast<std::size_t>(rank_);
    {
      const std::lock_guard lock(meeting_.mutex);
      meeting_.brought.resize(all.size());
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(own), share,
                  meeting_.brought.begin() + static_cast<std::ptrdiff_t>(own));
    }
    meeting_.all_here.arrive_and_wait();
    std::ranges::copy(meeting_.brought, all.begin());
    meeting_.all_here.arrive_and_wait();
  }

  Meeting& meeting_;
  int rank_;
  int count_;
};

/// Calls `job` on so many ranks side by side; throws what a rank threw.
inline void on_ranks(int count, const std::function<void(Ranks&)>& job) {
  ThreadRanks::Meeting meeting(count);
  std::vector<std::exception_ptr> thrown(static_cast<std::size_t>(count));
  std::vector<std::thread> threads;
  for (int rank = 0; rank < count; ++rank) {
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(meeting, rank, count);
      try {
        job(ranks);
      } catch (...) {
        thrown[static_cast<std::size_t>(rank)] = std::current_exception();
        meeting.all_here.arrive_and_drop();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& exception : thrown) {
    if (exception != nullptr) std::rethrow_exception(exception);
  }
}

}  // namespace hqslam::test
