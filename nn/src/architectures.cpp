#include <algorithm>

#include "architecture.h"
#include "hqs/hqs_architecture.h"

namespace hqslam::nn {
namespace {

std::vector<NamedArchitecture>& all() {
  static std::vector<NamedArchitecture> kinds{
      {"du-or", read_du_or}, {"simple-du", read_simple_du}, {"du-mix", read_du_mix}};
  return kinds;
}

}  // namespace

std::span<const NamedArchitecture> architectures() { return all(); }

void add_architecture(const NamedArchitecture& added) {
  const auto same = [&](const NamedArchitecture& known) { return known.read == added.read; };
  if (std::ranges::none_of(all(), same)) all().push_back(added);
}

}  // namespace hqslam::nn
