#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hqslam::test {

/// FNV-1a, 64 bits, of the bytes of all values, going on from `hash`.
std::uint64_t hash_of(const auto& values, std::uint64_t hash = 14695981039346656037ULL) {
  for (const std::byte byte : std::as_bytes(std::span(values))) {
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 1099511628211ULL;
  }
  return hash;
}

}  // namespace hqslam::test
