#include "terminal/command_options.h"

#include "tools/command_line/parsed_options.h"

using namespace hqslam::tools;

namespace {

/// Why an option refuses a value.
std::string refusal_of(const std::string& value, const OptionRules& rules) {
  CLI::App app;
  std::string target;
  tools::add_command(app, "run", "what").option("--method", &target, "how", rules);
  try {
    tools::parse(app, {"run", "--method", value});
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("an option refuses nan, and proposes the nearest of the names that it takes") {
  CHECK(refusal_of("nan", {.within = std::pair(0.0, 1.0)}) ==
        "--method: expected a number, found nan");
  const OptionRules names = {.one_of = {"linear", "inverse"}};
  CHECK(refusal_of("linear", names).empty());
  CHECK(refusal_of("liner", names) ==
        "--method: expected one of linear, inverse, found liner; did you mean 'linear'?");
  CHECK(refusal_of("7", names) == "--method: expected one of linear, inverse, found 7");
}

TEST_CASE("an option that takes a file or a name takes either, and names both where it refuses") {
  const OptionRules file_or_name = {.given = Given::kFile, .one_of = {"none"}};
  CHECK(refusal_of("none", file_or_name).empty());
  CHECK(refusal_of("/proc/self/status", file_or_name).empty());
  CHECK(refusal_of("/no/file", file_or_name) ==
        "--method: expected an existing file or none, found /no/file");
}
