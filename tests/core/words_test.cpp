#include "../../core/src/words.h"

#include <doctest/doctest.h>

#include <cstdint>

using namespace hqslam;

TEST_CASE("words are what stands between separators, at most as many as are asked for") {
  using Words = std::vector<std::string_view>;
  CHECK(words_of("  a bc\t d\r") == Words{"a", "bc", "d"});
  CHECK(words_of(" \t").empty());
  CHECK(words_of("a,b;;c d", ",;") == Words{"a", "b", "c d"});
  CHECK(words_of("a b c", kSpace, 2) == Words{"a", "b"});
}

TEST_CASE("lines are taken off a text, the last one with an end or without") {
  std::string_view rest = "a\n\nb";
  CHECK(next_line(rest) == "a");
  CHECK(next_line(rest).empty());
  CHECK(next_line(rest) == "b");
  CHECK(rest.empty());
  rest = "c\n";
  CHECK(next_line(rest) == "c");
  CHECK(rest.empty());
}

TEST_CASE("a word is a number as a whole or not at all") {
  CHECK(number_from<double>("-1.5e2") == -150.0);
  CHECK(number_from<std::uint8_t>("255") == 255);
  CHECK_FALSE(number_from<std::uint8_t>("256"));
  CHECK_FALSE(number_from<std::size_t>("-1"));
  for (const char* word : {"", "1x", "x", "1 ", " 1", "1e999"}) {
    CAPTURE(word);
    CHECK_FALSE(number_from<double>(word));
  }
}
