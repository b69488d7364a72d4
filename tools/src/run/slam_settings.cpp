#include "run/slam_settings.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/json_limits.h"
#include "hqslam/core/whole_file.h"

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
    throw Error(
        fmt::format("{}: {}; hqslam slam-options --json >options.json makes such a "
                    "file",
                    path, what));
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
  const std::string_view number =
      equals == std::string::npos ? std::string_view() : std::string_view(text).substr(equals + 1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size()) {
    throw Error(
        fmt::format("--set {}: expected NAME=NUMBER, as in mapping.max_iterations=12; "
                    "hqslam slam-options lists the names",
                    text));
  }
  slam::set_option(options, text.substr(0, equals), value);
}

}  // namespace

void declare_slam_settings(CLI::App& command, SlamSettings& settings) {
  command
      .add_option("--slam-options", settings.file,
                  "JSON file of SLAM's options that are not to be the defaults; hqslam "
                  "slam-options --json >options.json makes one of all")
      ->check(CLI::ExistingFile);
  command
      .add_option("--set", settings.set,
                  "One option of SLAM, NAME=NUMBER, after the file; may be given several times")
      ->allow_extra_args(false);
  command.add_flag_callback(
      "--no-loop-closing", [&settings] { settings.loop_closing = false; },
      "Do not recognise places passed before, nor correct the path and the map");
}

slam::SlamOptions slam_options(const SlamSettings& settings) {
  slam::SlamOptions options;
  if (!settings.file.empty()) set_from_file(options, settings.file);
  for (const std::string& text : settings.set) set_from_text(options, text);
  options.loop_closing.enabled = settings.loop_closing;
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
