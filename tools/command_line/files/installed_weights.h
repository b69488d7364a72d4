#pragma once

#include <optional>
#include <string>

namespace hqslam::tools {

/// The path of a weights file that comes with the program, "du-or_os1_16to64.npz" say: beside the
/// installed program (../share/hqslam/weights) or in the source tree it was built from. Nothing if
/// it is in neither.
std::optional<std::string> installed_weights(const std::string& name);

}  // namespace hqslam::tools
