#include "hqslam/core/nearest_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace hqslam {
namespace {

constexpr std::size_t kMostNames = 3;
constexpr std::size_t kLongestName = 64;  // the distance takes the product of both lengths

/// The least number of letters to insert, remove or replace.
std::size_t edits(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// Those that did_you_mean names.
std::vector<std::string> nearest_names(std::string_view mistyped,
                                       const std::vector<std::string>& names) {
  mistyped = mistyped.substr(0, kLongestName);
  const auto holds = [&](const std::string& name) {
    return mistyped.size() > 1 && name.find(mistyped) != std::string::npos;
  };
  const std::size_t most_edits =
      std::ranges::any_of(names, holds) ? 0 : std::max<std::size_t>(1, mistyped.size() / 3);
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& name : names) {
    const std::size_t distance = holds(name) ? 0 : edits(mistyped, name.substr(0, kLongestName));
    if (distance <= most_edits) near.emplace_back(distance, name);
  }
  std::ranges::stable_sort(near, {}, &std::pair<std::size_t, std::string>::first);
  near.resize(std::min(near.size(), kMostNames));
  std::vector<std::string> nearest;
  for (auto& [distance, name] : near) nearest.push_back(std::move(name));
  return nearest;
}

}  // namespace

std::string did_you_mean(std::string_view mistyped, const std::vector<std::string>& names) {
  std::vector<std::string> nearest = nearest_names(mistyped, names);
  if (nearest.empty()) return "";
  for (std::string& name : nearest) name = fmt::format("'{}'", name);
  return fmt::format("; did you mean {}?", fmt::join(nearest, " or "));
}

}  // namespace hqslam
