#pragma once

#include <string>

namespace hqslam::tools {

/// A word as a shell takes it: in quotes where the shell would read anything into it.
std::string shell_word(const std::string& word);
/// Keeps how the program was started, for pages that show it. To be called once, by main's thread.
void keep_invocation(const std::string& program, int argc, const char* const* argv);
/// As a shell takes it: "hqslam run 'my drive' --out results"; empty where main kept none.
const std::string& invocation();

}  // namespace hqslam::tools
