#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hqslam::tools {

/// The seed that a text says, a whole number from 0 to 2^64 - 1; nothing if it says none.
std::optional<std::uint64_t> seed_from(std::string_view text);

/// "1..10", "3,5" or "1..3,7": the seeds in the order given, at most 10,000. Throws Error for
/// anything else, and for a seed that is there twice.
std::vector<std::uint64_t> seeds_from(const std::string& list);

}  // namespace hqslam::tools
