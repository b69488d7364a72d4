#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace hqslam::tools {

/// One of many jobs, by its number. Checks now and then whether the others have `stopped`. Returns
/// false if it was interrupted.
using SideJob = std::function<bool(std::size_t job, const std::atomic<bool>& stopped)>;

/// Does `jobs` jobs, `workers` of them side by side, on threads of their own with `threads_inside`
/// OpenMP threads each. Returns false if a job did. Throws what a job throws, once the others have
/// stopped.
bool side_by_side(std::size_t jobs, int workers, int threads_inside, const SideJob& job);

}  // namespace hqslam::tools
