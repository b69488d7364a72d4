#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace hqslam::tools {

/// The seed that a text says, a whole number from 0 to 2^64 - 1; nothing if it says none.
std::optional<std::uint64_t> seed_from(std::string_view text);

}  // namespace hqslam::tools
