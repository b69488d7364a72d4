#include "program/help_formatter.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "product.h"
#include "tools/command_line/parsed_options.h"

namespace hqslam::tools {

TEST_CASE("every command's help fits 80 columns") {
  std::istringstream commands(
      " run live info map view evaluate inspect calibrate upsample weights slam-options");
  for (std::string command; commands >> command;) {
    CAPTURE(command);
    std::istringstream help(help_of<ProductCommands>(product_text(), command.c_str()));
    for (std::string line; std::getline(help, line);) {
      CAPTURE(line);
      CHECK(line.size() <= HelpFormatter::kWidth);
    }
  }
}

TEST_CASE("paragraphs are filled, lines that begin with a space stay apart") {
  CHECK(filled("one two\nthree\n  a  b\nfour five", 9) == "one two\nthree\n  a  b\nfour five\n");
  CHECK(filled("one\ntwo three", 9) == "one two\nthree\n");
  CHECK(filled("  aaaa bbbb cccc", 9) == "  aaaa\n  bbbb\n  cccc\n");
}

TEST_CASE("an entry's further lines go on below its explanation, whatever the source's lines are") {
  CHECK(filled("Words\n  APE   one two\n        three four\n  a, b  five\nend", 18) ==
        "Words\n  APE   one two\n        three four\n  a, b  five\nend\n");
  CHECK(filled("  APE   one two three\n        four", 18) ==
        "  APE   one two\n        three four\n");
  CHECK(filled("  APE   one two three", 18) == "  APE   one two\n        three\n");
}

}  // namespace hqslam::tools
