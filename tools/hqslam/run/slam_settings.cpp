#include "run/slam_settings.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam::tools {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLargestFile_bytes = 1 << 20;

/// {"mapping": {"max_iterations": 12}}: the names of a table's options, cut at the point.
void set_from_file(slam::SlamOptions& options, const std::string& path) {
  const std::string text = whole_file(path, "a .json file", kLargestFile_bytes);
  check_json_limits(text, path);
  const Json json = Json::parse(text, nullptr, false);
  const auto complain = [&](const std::string& what) {
    throw Error("{}: {}; hqslam slam-options --json >options.json makes such a file", path, what);
  };
  if (!json.is_object()) complain("expected a JSON object of SLAM's stages");
  for (const auto& [part, fields] : json.items()) {
    if (!fields.is_object()) complain(fmt::format("expected an object in \"{}\"", part));
    for (const auto& [field, value] : fields.items()) {
      const std::string name = fmt::format("{}.{}", part, field);
      if (!value.is_number()) complain(fmt::format("expected a number in {}", name));
      try {
        slam::set_option(options, name, value.get<double>());
      } catch (const Error& error) {
        complain(error.what());
      }
    }
  }
}

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
      .option("--slam-options", &settings.file,
              "JSON file of SLAM's options that differ from the defaults; hqslam slam-options "
              "--json >options.json writes one with all of them",
              {.given = Given::kFile})
      .option("--set", &settings.set,
              "NAME=NUMBER: one option of SLAM, which replaces that of --slam-options (may be "
              "repeated)",
              {.one_at_a_time = true})
      .option(
          "--no-loop-closing", [&settings] { settings.loop_closing = false; },
          "Do not recognize places passed before, nor correct path and map");
}

pipeline::SlamKind slam_kind(const SlamSettings& settings) {
  if (settings.kind != "lego-loam") return pipeline::SlamKind::kHqslam;
  if (settings.file.empty() && settings.set.empty()) return pipeline::SlamKind::kLegoLoam;
  throw Error("--slam lego-loam: has no options; leave {} out",
              settings.file.empty() ? "--set" : "--slam-options");
}

slam::SlamOptions slam_options(const SlamSettings& settings) {
  slam::SlamOptions options;
  if (!settings.file.empty()) set_from_file(options, settings.file);
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
