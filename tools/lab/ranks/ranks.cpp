#include "ranks/ranks.h"

#include <omp.h>

#include <cstdlib>
#include <exception>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hqslam/core/error.h"
#include "terminal/terminal.h"

// The only file that uses MPI, where it is installed.
#ifdef HQSLAM_MPI
#include <mpi.h>
#endif

namespace hqslam::tools {

#ifdef HQSLAM_MPI
namespace {

/// Whether Open MPI, PMIx (srun --mpi=pmix) or PMI (srun --mpi=pmi2, MPICH) started this process.
bool was_launched() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

class MpiRanks : public Ranks {
 public:
  MpiRanks() {
    int granted = MPI_THREAD_SINGLE;  // other threads compute, this one alone talks
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &granted);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
    if (rank_ > 0) print_messages_alone();
  }
  ~MpiRanks() override {
    // After an exception the other processes would wait forever. mpirun notices a process that ends
    // without MPI_Finalize and ends all.
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int count() const override { return count_; }

 private:
  void gather_bytes(std::span<std::byte> all) override {
    const std::size_t share = all.size() / static_cast<std::size_t>(count_);
    if (share > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw Error(
          "{} bytes of each process, expected less than 2 GiB; train with fewer samples of a batch "
          "in a process",
          share);
    }
    MPI_Allgather(MPI_IN_PLACE, 0, MPI_BYTE, all.data(), static_cast<int>(share), MPI_BYTE,
                  MPI_COMM_WORLD);
  }

  int rank_ = 0;
  int count_ = 1;
};

}  // namespace

std::unique_ptr<Ranks> launched_ranks() {
  if (!was_launched()) return std::make_unique<Ranks>();
  return std::make_unique<MpiRanks>();
}

#else

std::unique_ptr<Ranks> launched_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* const count = std::getenv(name);
    if (count == nullptr || std::string(count) == "1") continue;
    throw Error(
        "started as one of {} processes, but built without MPI; install libopenmpi-dev and build "
        "again, or start it once",
        count);
  }
  return std::make_unique<Ranks>();
}

#endif

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
