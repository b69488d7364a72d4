#include "terminal/command_options.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>

#include "hqslam/core/nearest_names.h"

// Apart from command_line.cpp the only file that includes CLI11, which takes seconds to compile.

namespace hqslam::tools {
namespace {

/// `check`, which takes one of some names, with a message that proposes the nearest of them.
CLI::Validator with_proposals(CLI::Validator check, const OptionRules& rules) {
  const std::string expected =
      fmt::format("{}{}{}", rules.given == Given::kAnything ? "" : "an existing file or ",
                  rules.one_of.size() > 1 ? "one of " : "", fmt::join(rules.one_of, ", "));
  const auto refuse = [check, expected, names = rules.one_of](std::string& value) -> std::string {
    if (check(value).empty()) return "";
    return fmt::format("expected {}, found {}{}", expected, value, did_you_mean(value, names));
  };
  return check.operation(refuse);
}

void check_given(CLI::Option& option, const OptionRules& rules) {
  static const std::map<Given, CLI::Validator> checks = {
      {Given::kFile, CLI::ExistingFile},
      {Given::kFolder, CLI::ExistingDirectory},
      {Given::kFileOrFolder, CLI::ExistingPath},
      {Given::kNotNegative, CLI::NonNegativeNumber}};
  const auto check = checks.find(rules.given);
  if (rules.one_of.empty()) {
    if (check != checks.end()) option.check(check->second);
  } else if (check == checks.end()) {
    option.check(with_proposals(CLI::IsMember(rules.one_of), rules));
  } else {
    option.check(with_proposals(check->second | CLI::IsMember(rules.one_of), rules));
  }
}

std::string refuse_nan(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr)) ? "expected a number, found " + text : "";
}

void apply(const OptionRules& rules, CLI::App& command, CLI::Option& option) {
  option.required(rules.required);
  check_given(option, rules);
  if (const auto* ints = std::get_if<std::pair<int, int>>(&rules.within)) {
    option.check(CLI::Range(ints->first, ints->second));
  } else if (const auto* reals = std::get_if<std::pair<double, double>>(&rules.within)) {
    option.check(CLI::Range(reals->first, reals->second));
    option.check(refuse_nan);  // CLI::Range takes nan
  }
  if (rules.complaint) option.check(rules.complaint);
  if (rules.delimiter != 0) option.delimiter(rules.delimiter);
  if (rules.values > 0) option.expected(rules.values);
  if (rules.one_at_a_time) option.allow_extra_args(false);
  if (!rules.if_bare.empty()) option.expected(0, 1)->default_str(rules.if_bare);
  if (rules.shows_default) option.capture_default_str();
  for (const char* needed : rules.needs) option.needs(command.get_option(needed));
  for (const char* excluded : rules.excludes) option.excludes(command.get_option(excluded));
}

}  // namespace

Command& Command::option(const std::string& name, const OptionTarget& value,
                         const std::string& help, const OptionRules& rules) {
  CLI::Option* added = std::visit(
      [&](const auto& target) -> CLI::Option* {
        using Target = std::decay_t<decltype(target)>;
        if constexpr (std::is_same_v<Target, bool*>)
          return app_->add_flag(name, *target, help);
        else if constexpr (std::is_pointer_v<Target>)
          return app_->add_option(name, *target, help);
        else
          return app_->add_flag_callback(name, target, help);
      },
      value);
  apply(rules, *app_, *added);
  return *this;
}

Command Command::alternatives(const std::string& heading, const std::string& what) {
  CLI::App* group = app_->add_option_group(heading, what);
  group->require_option(1);
  return Command(*group);
}

Command Command::subcommand(const std::string& name, const std::string& what,
                            const std::string& footer) {
  app_->require_subcommand(1);
  return add_command(*app_, name, what, footer);
}

Command add_command(CLI::App& app, const std::string& name, const std::string& what,
                    const std::string& footer) {
  CLI::App* command = app.add_subcommand(name, what);
  if (!footer.empty()) command->footer(footer);
  return Command(*command);
}

}  // namespace hqslam::tools
