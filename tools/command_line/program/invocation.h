#pragma once

#include <string>

namespace hqslam::tools {

/// Keeps how the program was started, for pages that say it. To be called once, by main's thread.
void keep_invocation(const std::string& program, int argc, const char* const* argv);
/// As a shell takes it: "hqslam run 'my drive' --out results"; empty where main kept none.
const std::string& invocation();

}  // namespace hqslam::tools
