#include "run/slam_settings.h"

#include <optional>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/words.h"

namespace hqslam::tools {

namespace {

/// "mapping.max_iterations=12"
void set_from_text(slam::SlamOptions& options, const std::string& text) {
  const std::size_t equals = text.find('=');
  const auto value = equals == std::string::npos
                         ? std::nullopt
                         : number_from<double>(std::string_view(text).substr(equals + 1));
  if (!value) {
    throw Error(
        "--set {}: expected NAME=NUMBER, as in mapping.max_iterations=12; hqslam slam-options "
        "lists the names",
        text);
  }
  slam::set_option(options, text.substr(0, equals), *value);
}

}  // namespace

void declare_slam_kind(Command& command, SlamSettings& settings) {
  command.option("--slam", &settings.kind,
                 "hqslam's own SLAM, or LeGO-LOAM as its paper describes it, without loop closing, "
                 "covariances and saved maps",
                 {.shows_default = true, .one_of = {"hqslam", "lego-loam"}});
}

void declare_slam_settings(Command& command, SlamSettings& settings) {
  command
      .option(
          "--set", &settings.set,
          "NAME=NUMBER: one option of SLAM, as hqslam slam-options lists them (may be repeated)",
          {.one_at_a_time = true})
      .option(
          "--no-loop-closing", [&settings] { settings.loop_closing = false; },
          "Do not recognize places passed before, nor correct path and map");
}

pipeline::SlamKind slam_kind(const SlamSettings& settings) {
  if (settings.kind != "lego-loam") return pipeline::SlamKind::kHqslam;
  if (settings.set.empty()) return pipeline::SlamKind::kLegoLoam;
  throw Error("--slam lego-loam: has no options; leave --set out");
}

slam::SlamOptions slam_options(const SlamSettings& settings) {
  slam::SlamOptions options;
  for (const std::string& text : settings.set) set_from_text(options, text);
  options.loop_closing.enabled = settings.loop_closing && settings.kind != "lego-loam";
  slam::validate(options);
  return options;
}

std::vector<std::pair<std::string, double>> changed_options(const slam::SlamOptions& options) {
  const slam::SlamOptions defaults;
  std::vector<std::pair<std::string, double>> changed;
  for (const slam::NamedOption& option : slam::option_table()) {
    if (option.get(options) == option.get(defaults)) continue;
    changed.emplace_back(std::string(option.name), option.get(options));
  }
  return changed;
}

}  // namespace hqslam::tools
