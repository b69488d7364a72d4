#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

#include "hqslam/nn/training/ranks.h"

namespace hqslam::tools {

/// The processes that mpirun or srun started together with this one; one alone where none did. All
/// but rank 0 print nothing but what goes wrong with themselves. Once in a program. Throws Error
/// where there are several, but the program was built without MPI.
///
/// Where something is thrown while the result lives, its processes do not wait for each other any
/// more: this one ends, and whoever started them ends the others.
std::unique_ptr<Ranks> launched_ranks();

/// Whether what stands at this place among all is this rank's share.
inline bool is_own(std::size_t place, const Ranks& ranks) {
  return place % static_cast<std::size_t>(ranks.count()) == static_cast<std::size_t>(ranks.rank());
}

/// One of many jobs, by its number. Returns false if it was interrupted; is to look now and then
/// whether the others have stopped.
using SideJob = std::function<bool(std::size_t job, const std::atomic<bool>& stopped)>;

/// Does `jobs` jobs, `workers` of them side by side, on threads of their own with `threads_inside`
/// OpenMP threads each. Returns false if a job did. Throws what a job throws, once the others have
/// stopped.
bool side_by_side(std::size_t jobs, int workers, int threads_inside, const SideJob& job);

}  // namespace hqslam::tools
