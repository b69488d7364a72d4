#include "hqslam/core/excerpt.h"

#include <doctest/doctest.h>

#include <string>

using hqslam::excerpt;

TEST_CASE("what would steer a terminal or break a line is shown instead") {
  CHECK(excerpt("a\nb\tc\rd") == "a\\nb\\tc\\rd");
  CHECK(excerpt("\x1b[2J\x07\x7f") == "\\x1b[2J\\x07\\x7f");
  CHECK(excerpt(std::string("a\0b", 3)) == "a\\x00b");
  CHECK(excerpt("\xc2\x9b"
                "31m") == "\\xc2\\x9b31m");  // the control character U+009B
}

TEST_CASE("letters of all kinds stay, bytes that are no UTF-8 are shown as numbers") {
  CHECK(excerpt("Größe 東京 🛰") == "Größe 東京 🛰");
  CHECK(excerpt("\xe4"
                "b") ==
        "\\xe4"
        "b");
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
