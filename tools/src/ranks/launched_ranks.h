#pragma once

#include <memory>

#include "hqslam/core/ranks.h"

namespace hqslam::tools {

/// The processes that mpirun or srun started together with this one; one alone where none did. All
/// but rank 0 print nothing but what goes wrong with themselves. Once in a program. Throws Error
/// where there are several, but the program was built without MPI.
///
/// Where something is thrown while the result lives, its processes do not wait for each other any
/// more: this one ends, and whoever started them ends the others.
std::unique_ptr<Ranks> launched_ranks();

}  // namespace hqslam::tools
