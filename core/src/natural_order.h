#pragma once

#include <string_view>

namespace hqslam {

/// Whether `a` comes before `b` when numbers inside names count by their value: "scan9" before
/// "scan10".
bool naturally_before(std::string_view a, std::string_view b);

}  // namespace hqslam
