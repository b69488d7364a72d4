#pragma once

#include <string>

namespace hqslam::tools {

/// The processor as the system calls it, "unknown processor" if it does not say.
std::string processor_name();

}  // namespace hqslam::tools
