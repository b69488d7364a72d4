#include <fmt/format.h>

#include <sstream>
#include <string>

#include "hqslam/slam/options.h"
#include "product.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct SlamOptionsCommand {};

void declare(CLI::App& app, SlamOptionsCommand&) {
  add_command(app, "slam-options", "List the options of SLAM: names, defaults, bounds and meanings",
              "Lengths in metres, angles in radians. Given to run and live by --set NAME=NUMBER.\n"
              "LeGO-LOAM's values are given where they differ.");
}

/// Lines of at most 80 columns, indented by four.
std::string wrapped(const std::string& text) {
  constexpr std::size_t kMostColumns = 80;
  std::string lines;
  std::string line = "   ";
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kMostColumns) {
      lines += line + "\n";
      line = "   ";
    }
    line += " " + word;
  }
  return lines + line;
}

int run(const SlamOptionsCommand&) {
  const slam::SlamOptions defaults;
  to_stdout("{:<42} {}\n", "option", "default");
  for (const slam::NamedOption& option : slam::option_table()) {
    to_stdout("{:<42} {:.4g}\n{}\n", option.name, option.get(defaults),
              wrapped(fmt::format("{} ({})", option.meaning, option.expected)));
  }
  return kOk;
}

}  // namespace

void add_slam_options(CLI::App& app, Chosen& chosen) {
  add_subcommand<SlamOptionsCommand>(app, chosen);
}

}  // namespace hqslam::tools
