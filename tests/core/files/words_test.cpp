#include "hqslam/core/words.h"

#include "hqslam/core/excerpt.h"
#include "testing.h"

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

TEST_CASE("numbers inside names count by their value") {
  CHECK(naturally_before("scan99999999999999999999", "scan100000000000000000000"));
  const std::vector<std::string> ordered = {"",       "0001",   "01",      "1",     "2",      "10",
                                            "a1.bin", "a9.bin", "a10.bin", "a10b2", "a10b10", "b"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      CAPTURE(ordered[i]);
      CAPTURE(ordered[j]);
      CHECK(naturally_before(ordered[i], ordered[j]) == (i < j));
    }
  }
}

TEST_CASE("what would steer a terminal or break a line is shown instead") {
  CHECK(excerpt("a\nb\tc\rd") == "a\\nb\\tc\\rd");
  CHECK(excerpt("\x1b[2J\x07\x7f") == "\\x1b[2J\\x07\\x7f");
  CHECK(excerpt(std::string("a\0b", 3)) == "a\\x00b");
  CHECK(excerpt("\302\23331m") == "\\xc2\\x9b31m");  // the control character U+009B
}

TEST_CASE("letters of all kinds stay, bytes that are no UTF-8 are shown as numbers") {
  CHECK(excerpt("Größe 東京 🛰") == "Größe 東京 🛰");
  CHECK(excerpt("\344b") == "\\xe4b");
  CHECK(excerpt("\xc3") == "\\xc3");
  CHECK(excerpt("\xe6\x9d") == "\\xe6\\x9d");
  CHECK(excerpt("\xc0\xaf\xff") == "\\xc0\\xaf\\xff");
}

TEST_CASE("a long text is cut between characters, and says so") {
  CHECK(excerpt("12345", 5) == "12345");
  CHECK(excerpt("123456", 5) == "12345...");
  CHECK(excerpt("äöüäöü", 3) == "äöü...");
  CHECK(excerpt(std::string(1'000'000, '\n')).size() == 2 * 30 + 3);
}
