#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "hqslam/slam/options.h"
#include "product.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct SlamOptionsCommand {
  bool json = false;
};

using Json = nlohmann::ordered_json;

std::string json_of_defaults() {
  const slam::SlamOptions defaults;
  Json json;
  for (const slam::NamedOption& option : slam::option_table()) {
    const std::size_t point = option.name.find('.');
    const std::string part(option.name.substr(0, point));
    const std::string field(option.name.substr(point + 1));
    const double value = option.get(defaults);
    json[part][field] = option.is_whole ? Json(static_cast<int>(value)) : Json(value);
  }
  return json.dump(2) + "\n";
}

void declare(CLI::App& app, SlamOptionsCommand& options) {
  add_command(app, "slam-options", "List the options of SLAM: names, defaults, bounds and meanings",
              "Lengths in metres, angles in radians. Given to run and live by --slam-options "
              "FILE.json\n"
              "and --set NAME=NUMBER. LeGO-LOAM's values are given where they differ.")
      .option("--json", &options.json,
              "Print JSON; >options.json makes a file of it for run --slam-options");
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

int run(const SlamOptionsCommand& options) {
  if (options.json) {
    to_stdout("{}", json_of_defaults());
    return kOk;
  }
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
