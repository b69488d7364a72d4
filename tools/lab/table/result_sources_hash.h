#pragma once

#include <string>

namespace hqslam::tools {

/// 16 digits that change with the sources of the libraries and of what stands between them in the
/// programs, with the compiler and with its flags: results of different builds are not the same
/// thing.
std::string result_sources_hash();

}  // namespace hqslam::tools
