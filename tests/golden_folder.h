#pragma once

#include <string>

namespace hqslam {

/// Folder of the files made by other programs; tools/make_golden.py says how.
std::string golden_folder();

}  // namespace hqslam
