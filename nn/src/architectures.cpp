#include <array>

#include "architecture.h"
#include "direct/srae.h"
#include "direct/tulip.h"
#include "hqs/du_mix.h"
#include "hqs/unrolled_hqs.h"

namespace hqslam::nn {

std::span<const NamedArchitecture> architectures() {
  static constexpr std::array kArchitectures{
      NamedArchitecture{"du-or", read_du_or},   NamedArchitecture{"simple-du", read_simple_du},
      NamedArchitecture{"du-mix", read_du_mix}, NamedArchitecture{"srae", read_srae},
      NamedArchitecture{"tulip", read_tulip},
  };
  return kArchitectures;
}

}  // namespace hqslam::nn
