#include "program/help_formatter.h"

#include "product.h"
#include "tools/command_line/parsed_options.h"

namespace hqslam::tools {

TEST_CASE("every command's help fits 80 columns") {
  std::istringstream commands(
      " run live info map view evaluate inspect calibrate upsample weights slam-options");
  for (std::string command; commands >> command;) {
    CAPTURE(command);
    std::istringstream help(help_of(product(), command));
    for (std::string line; std::getline(help, line);) {
      CAPTURE(line);
      CHECK(line.size() <= HelpFormatter::kWidth);
    }
  }
}

TEST_CASE("paragraphs are filled, lines that begin with a space stay as they are") {
  const std::string word(40, 'a');
  CHECK(filled("one\ntwo " + word + " " + word + "\n  a  b\n\nthree") ==
        "one two " + word + "\n" + word + "\n  a  b\n\nthree\n");
}

}  // namespace hqslam::tools
