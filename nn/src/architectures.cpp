#include <algorithm>

#include "architecture.h"
#include "hqs/hqs_architecture.h"

namespace hqslam::nn {
namespace {

std::vector<NamedArchitecture>& all() {
  static std::vector<NamedArchitecture> kinds{
      {"du-or", [](JsonFields& network) { return read_hqs(kDuOr, network); }},
      {"simple-du", [](JsonFields& network) { return read_hqs(kSimpleDu, network); }},
      {"du-mix", [](JsonFields& network) { return read_hqs(kDuMix, network); }}};
  return kinds;
}

}  // namespace

std::span<const NamedArchitecture> architectures() { return all(); }

void add_architecture(const NamedArchitecture& added) {
  const auto same = [&](const NamedArchitecture& known) { return known.read == added.read; };
  if (std::ranges::none_of(all(), same)) all().push_back(added);
}

}  // namespace hqslam::nn
