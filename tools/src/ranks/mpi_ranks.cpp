#include <fmt/format.h>
#include <mpi.h>

#include <cstdlib>
#include <exception>
#include <limits>

#include "hqslam/core/error.h"
#include "ranks/launched_ranks.h"
#include "terminal/terminal.h"

// The only file that knows MPI. Compiled where MPI is installed, single_rank.cpp where it is not.

namespace hqslam::tools {
namespace {

/// What Open MPI, PMIx (srun --mpi=pmix) and PMI (srun --mpi=pmi2, MPICH) tell each process.
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
    // Whoever waits for a process that threw would wait for ever; one that ends without having
    // finalized is noticed by what started it, which then ends all.
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
          fmt::format("{} bytes of each process, expected less than 2 GiB; train with fewer "
                      "samples of a batch in a process",
                      share));
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

}  // namespace hqslam::tools
