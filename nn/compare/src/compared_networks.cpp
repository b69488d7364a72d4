#include "hqslam/nn/compare/compared_networks.h"

#include "srae.h"
#include "tulip.h"

namespace hqslam::nn {

const Architectures& all_architectures() {
  static const Architectures kinds = [] {
    Architectures all = hqs_architectures();
    all.push_back({"srae", read_srae});
    all.push_back({"tulip", read_tulip});
    return all;
  }();
  return kinds;
}

}  // namespace hqslam::nn
