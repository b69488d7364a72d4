#include "hqslam/nn/compare/compared_networks.h"

#include "srae.h"

namespace hqslam::nn {

const Architectures& all_architectures() {
  static const Architectures kinds = [] {
    Architectures all = hqs_architectures();
    all.push_back({"srae", read_srae});
    return all;
  }();
  return kinds;
}

}  // namespace hqslam::nn
