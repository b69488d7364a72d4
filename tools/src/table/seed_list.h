#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hqslam::tools {

/// "1..10", "3,5" or "1..3,7": the seeds in the order given, at most 10,000. Throws Error for
/// anything else, and for a seed that is there twice.
std::vector<std::uint64_t> seeds_from(const std::string& list);

}  // namespace hqslam::tools
