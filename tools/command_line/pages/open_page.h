#pragma once

#include <string>
#include <vector>

namespace hqslam::tools {

class Command;

/// --open: show the page that the command writes.
void declare_open(Command& command, bool& open, const std::vector<const char*>& needs = {});

/// Shows a file or an address in the user's browser, which outlives the program: by xdg-open (on
/// macOS open), without a shell. A failure is one line on stderr and ends nothing.
void open_page(const std::string& page);

}  // namespace hqslam::tools
