#pragma once

#include <memory>
#include <vector>

namespace hqslam {
class JsonFields;
}

namespace hqslam::nn {

class Architecture;

/// A kind of network that a description may name.
struct NamedArchitecture {
  const char* name;  ///< "kind" in JSON
  /// Takes what only this kind has out of a network's fields. Throws Error.
  std::shared_ptr<const Architecture> (*read)(JsonFields& network);
};

/// The kinds of networks that a reader accepts.
using Architectures = std::vector<NamedArchitecture>;

/// DU-OR, Simple DU and DU-Mix.
const Architectures& hqs_architectures();

}  // namespace hqslam::nn
