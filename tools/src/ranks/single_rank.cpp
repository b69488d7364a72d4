#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "hqslam/core/error.h"
#include "ranks/launched_ranks.h"

namespace hqslam::tools {

std::unique_ptr<Ranks> launched_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* const count = std::getenv(name);
    if (count == nullptr || std::string(count) == "1") continue;
    throw Error(fmt::format(
        "started as one of {} processes, but built without MPI; install libopenmpi-dev and build "
        "again, or start it once",
        count));
  }
  return std::make_unique<Ranks>();
}

}  // namespace hqslam::tools
