#include "content_hash.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <fstream>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

constexpr std::uint64_t kStart = 14695981039346656037ULL;
constexpr std::uint64_t kPrime = 1099511628211ULL;

std::uint64_t hashed(std::string_view bytes, std::uint64_t hash) {
  for (const char byte : bytes) hash = (hash ^ static_cast<std::uint8_t>(byte)) * kPrime;
  return hash;
}

std::string digits(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace

std::string content_hash(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(fmt::format("{}: cannot be read", path));
  std::uint64_t hash = kStart;
  std::array<char, 65536> buffer{};
  while (stream) {
    stream.read(buffer.data(), buffer.size());
    hash = hashed({buffer.data(), static_cast<std::size_t>(stream.gcount())}, hash);
  }
  return digits(hash);
}

std::string text_hash(std::string_view text) { return digits(hashed(text, kStart)); }

}  // namespace hqslam::tools
