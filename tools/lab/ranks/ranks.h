#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

#include "hqslam/nn/training/ranks.h"

namespace hqslam::tools {

/// The processes that mpirun or srun started together, this one included; a single one without
/// them. All but rank 0 print only their errors. To be called once in a program. Throws Error where
/// there are several processes but the program was built without MPI.
///
/// When an exception ends this process, it does not wait for the others; mpirun or srun then ends
/// them.
std::unique_ptr<Ranks> launched_ranks();

/// Whether the job at this place is in this rank's share.
inline bool is_own(std::size_t place, const Ranks& ranks) {
  return place % static_cast<std::size_t>(ranks.count()) == static_cast<std::size_t>(ranks.rank());
}

/// One of many jobs, by its number. Checks now and then whether the others have `stopped`. Returns
/// false if it was interrupted.
using SideJob = std::function<bool(std::size_t job, const std::atomic<bool>& stopped)>;

/// Does `jobs` jobs, `workers` of them side by side, on threads of their own with `threads_inside`
/// OpenMP threads each. Returns false if a job did. Throws what a job throws, once the others have
/// stopped.
bool side_by_side(std::size_t jobs, int workers, int threads_inside, const SideJob& job);

}  // namespace hqslam::tools
