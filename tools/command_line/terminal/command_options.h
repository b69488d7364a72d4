#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
}

namespace hqslam::tools {

/// What an option's text becomes. A bool: a flag; a function: a flag that calls it.
using OptionTarget =
    std::variant<bool*, std::function<void()>, std::string*, std::vector<std::string>*,
                 std::vector<double>*, int*, std::int64_t*, std::uint16_t*, float*, double*,
                 std::optional<float>*, std::optional<std::int64_t>*, std::optional<std::uint64_t>*,
                 std::optional<std::uint16_t>*>;

/// What an option accepts: what exists already, or which numbers.
enum class Given { kAnything, kFile, kFolder, kFileOrFolder, kNotNegative };

/// The values that an option accepts, and the options it needs or excludes.
struct OptionRules {
  bool required = false;
  bool shows_default = false;  ///< in --help
  Given given = Given::kAnything;
  std::vector<std::string> one_of = {};  ///< or, with kFile, a file; empty: anything
  /// Both ends included.
  std::variant<std::monostate, std::pair<int, int>, std::pair<double, double>> within = {};
  /// What is wrong with a text; empty where nothing is.
  std::function<std::string(const std::string&)> complaint = {};
  char delimiter = 0;          ///< of a list in one text
  int values = 0;              ///< how many it takes; 0: as its type has it
  bool one_at_a_time = false;  ///< a list that grows by one value each time that it is given
  std::string if_bare = {};    ///< its value where it is given without one; empty: it needs one
  std::vector<const char*> needs = {};     ///< options of the same command, declared by now
  std::vector<const char*> excludes = {};  ///< the same
};

/// A subcommand of the program, or a group of its options, while it is being declared.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  /// An option, or an argument where the name has no dashes.
  Command& option(const std::string& name, const OptionTarget& value, const std::string& help,
                  const OptionRules& rules = {});
  /// Options of which exactly one must be given, under a heading of their own.
  Command alternatives(const std::string& heading, const std::string& what);
  /// One of its own, of which exactly one must be given.
  Command subcommand(const std::string& name, const std::string& what,
                     const std::string& footer = "");

 private:
  CLI::App* app_;
};

/// A subcommand of the program. footer: behind its options in --help.
Command add_command(CLI::App& app, const std::string& name, const std::string& what,
                    const std::string& footer = "");

}  // namespace hqslam::tools
