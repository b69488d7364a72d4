#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "laboratory.h"
#include "tools/command_line/parsed_options.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

template <typename Options>
Options parsed(const std::vector<std::string>& arguments) {
  return parsed_options<LaboratoryCommands, Options>(laboratory_text(), arguments);
}

}  // namespace

TEST_CASE("every command that opens recordings reads them as run does") {
  const std::vector<std::string> reading = {"--stream",    "7502",        "--return", "last",
                                            "--capture",   "rolling",     "--stamps", "names",
                                            "--row-order", "lowest-first"};
  const auto with = [&]<typename Options>(Options, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), reading.begin(), reading.end());
    return parsed<Options>(arguments);
  };
  for (const InputChoice& choice :
       std::vector<InputChoice>{with(CompareOptions{}, {"compare", "/"}),
                                with(TableOptions{}, {"table", "--out", "x"}).reading,
                                with(BenchOptions{}, {"bench", "--input", "/"}).recording}) {
    CHECK(choice.stream == "7502");
    CHECK(choice.kept_return == "last");
    CHECK(choice.capture == "rolling");
    CHECK(choice.stamps == "names");
    CHECK(choice.row_order == "lowest-first");
  }
}

TEST_CASE("the options of table arrive where they belong, lists split at commas") {
  const auto table = parsed<TableOptions>(
      {"table", "--drives", "town,/", "--methods", "rows-16,du-or", "--weights", "a,b", "--sensor",
       "hdl-64e", "--scans", "7", "--out", "x", "--threads", "2"});
  CHECK(table.drives == std::vector<std::string>{"town", "/"});
  CHECK(table.methods == std::vector<std::string>{"rows-16", "du-or"});
  CHECK(table.weights == std::vector<std::string>{"a", "b"});
  CHECK(table.reading.sensor == "hdl-64e");
  CHECK(table.scans == 7);
  CHECK(table.out == "x");
  CHECK(table.threads == 2);
  CHECK(parsed<TableOptions>({"table", "--out", "x"}).drives ==
        std::vector<std::string>{"town", "hills"});
}

TEST_CASE("what makes no sense is refused") {
  const std::vector<std::vector<std::string>> wrong = {
      {"simulate", "--drive", "town", "--sensor", "os1-64", "--out", "x", "--scans", "-3"},
      {"bench", "--sensor", "os1-64"},
      {"compare", "/", "--layers"},
  };
  for (const std::vector<std::string>& arguments : wrong) {
    CAPTURE(arguments.size());
    CHECK_THROWS_AS(parsed<DemoOptions>(arguments), CLI::ParseError);
  }
}

TEST_CASE("a seed is a whole number from 0 to 2^64 - 1") {
  const auto seed = [](const std::string& text) {
    return parsed<SimulateOptions>(
               {"simulate", "--drive", "town", "--sensor", "vlp-16", "--out", "x", "--seed", text})
        .seed;
  };
  CHECK(seed("0") == 0);
  CHECK(seed("18446744073709551615") == 18446744073709551615ULL);
  for (const char* wrong :
       {"-1", "99999999999999999999", "18446744073709551616", "1.5", "0x10", "one", ""}) {
    CAPTURE(wrong);
    CHECK_THROWS_AS(seed(wrong), CLI::ParseError);
  }
}

TEST_CASE("the laboratory's help names every subcommand") {
  CHECK(missing(help_of<LaboratoryCommands>(laboratory_text()),
                {"demo", "simulate", "train", "compare", "table", "bench", "evaluate-map"}) == "");
}

}  // namespace hqslam::tools
