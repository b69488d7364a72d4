#include "../../core/src/lzf.h"

#include <doctest/doctest.h>

using hqslam::lzf_decompressed;

namespace {

std::string stream(std::initializer_list<int> bytes) {
  std::string result;
  for (const int byte : bytes) result += static_cast<char>(byte);
  return result;
}

}  // namespace

TEST_CASE("literals, short and long references and overlapping repeats are expanded") {
  CHECK(lzf_decompressed("", 0) == "");
  CHECK(lzf_decompressed(stream({2, 'a', 'b', 'c'}), 3) == "abc");
  // Repeat 3 bytes from 3 back.
  CHECK(lzf_decompressed(stream({2, 'a', 'b', 'c', 1 << 5, 2}), 6) == "abcabc");
  // Repeat 5 bytes from 1 back: the output feeds itself.
  CHECK(lzf_decompressed(stream({0, 'x', 3 << 5, 0}), 6) == "xxxxxx");
  // A long repeat: 9 + 255 bytes from 1 back, the longest there is.
  CHECK(lzf_decompressed(stream({0, 'y', 7 << 5, 255, 0}), 265) == std::string(265, 'y'));
  // A distance of more than 256: 300 bytes of literals, then 3 from 300 back.
  std::string literals;
  std::string plain;
  for (int i = 0; i < 300; i += 30) {
    literals += stream({29}) + std::string(30, static_cast<char>('a' + i / 30));
    plain += std::string(30, static_cast<char>('a' + i / 30));
  }
  CHECK(lzf_decompressed(literals + stream({(1 << 5) | 1, 43}), 303) == plain + "aaa");
}

TEST_CASE("a damaged stream gives nothing instead of reading or writing out of bounds") {
  CHECK_FALSE(lzf_decompressed(stream({2, 'a', 'b'}), 3));             // literal cut short
  CHECK_FALSE(lzf_decompressed(stream({2, 'a', 'b', 'c'}), 2));        // more than promised
  CHECK_FALSE(lzf_decompressed(stream({2, 'a', 'b', 'c'}), 4));        // less than promised
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 1 << 5, 1}), 4));       // before the beginning
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 1 << 5}), 4));          // reference cut short
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 7 << 5, 0}), 10));      // long reference cut short
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 7 << 5, 255, 0}), 9));  // repeat beyond the end
  CHECK_FALSE(lzf_decompressed("", 1));
  CHECK_FALSE(lzf_decompressed("abc", std::size_t{1} << 60U));  // no allocation
}
