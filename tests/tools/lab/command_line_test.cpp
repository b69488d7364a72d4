#include "laboratory.h"
#include "tools/command_line/parsed_options.h"

namespace hqslam::tools {

TEST_CASE("what makes no sense is refused") {
  CHECK_THROWS_AS(parse(laboratory(), {"simulate", "--drive", "town", "--sensor", "os1-64", "--out",
                                       "x", "--scans", "-3"}),
                  CLI::ParseError);
  CHECK_THROWS_AS(parse(laboratory(), {"compare", "/", "--layers"}), CLI::ParseError);
}

TEST_CASE("a seed is a whole number from 0 to 2^64 - 1") {
  const auto seed = [](const std::string& text) {
    return parsed_options<SimulateOptions>(
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

}  // namespace hqslam::tools
