#include "hqslam/core/ranks.h"

#include <algorithm>
#include <vector>

namespace hqslam {

bool Ranks::any(bool own) {
  std::vector<std::byte> said(static_cast<std::size_t>(count()));
  said[static_cast<std::size_t>(rank())] = std::byte{own};
  gather_bytes(said);
  return std::any_of(said.begin(), said.end(), [](std::byte one) { return one != std::byte{0}; });
}

}  // namespace hqslam
