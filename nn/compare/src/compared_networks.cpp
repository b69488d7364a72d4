#include "hqslam/nn/compare/compared_networks.h"

#include "srae.h"
#include "tulip.h"

namespace hqslam::nn {

void add_compared_networks() {
  add_architecture({"srae", read_srae});
  add_architecture({"tulip", read_tulip});
}

}  // namespace hqslam::nn
