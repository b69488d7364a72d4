#include "simulate/seed.h"

#include <fmt/format.h>

#include <charconv>
#include <set>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

constexpr std::size_t kMostSeeds = 10000;

[[noreturn]] void fail(const std::string& list) {
  throw Error(
      fmt::format("--seeds: expected different whole numbers such as 1..10 or 3,5,8, at "
                  "most {} of them, found '{}'",
                  kMostSeeds, list));
}

std::uint64_t seed_of(std::string_view text, const std::string& list) {
  const std::optional<std::uint64_t> seed = seed_from(text);
  if (!seed) fail(list);
  return *seed;
}

}  // namespace

std::optional<std::uint64_t> seed_from(std::string_view text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return seed;
}

std::vector<std::uint64_t> seeds_from(const std::string& list) {
  std::vector<std::uint64_t> seeds;
  std::set<std::uint64_t> known;
  std::string_view rest = list;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::string_view part = rest.substr(0, comma);
    rest.remove_prefix(more ? comma + 1 : rest.size());
    const std::size_t dots = part.find("..");
    const std::uint64_t first = seed_of(part.substr(0, dots), list);
    const std::uint64_t last =
        dots == std::string_view::npos ? first : seed_of(part.substr(dots + 2), list);
    if (last < first || last - first >= kMostSeeds - seeds.size()) fail(list);
    for (std::uint64_t i = 0; i <= last - first; ++i) {
      if (!known.insert(first + i).second) fail(list);
      seeds.push_back(first + i);
    }
  }
  return seeds;
}

}  // namespace hqslam::tools
