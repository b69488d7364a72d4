#include "simulate/seed.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "error_message.h"

namespace hqslam::tools {

TEST_CASE("seeds are ranges and single numbers, in the order given") {
  CHECK(seeds_from("7") == std::vector<std::uint64_t>{7});
  CHECK(seeds_from("2..4") == std::vector<std::uint64_t>{2, 3, 4});
  CHECK(seeds_from("9,1..2,5") == std::vector<std::uint64_t>{9, 1, 2, 5});
  CHECK(seeds_from("18446744073709551615").front() == 18446744073709551615ULL);
  CHECK(seeds_from("18446744073709551614..18446744073709551615").size() == 2);
}

TEST_CASE("anything else is refused with the list in one line") {
  for (const char* list : {"", "a", "1..", "..3", "3..1", "1,,2", "1,", "-1", "1..20000", "1.5",
                           "1 2", "1..3,2", "18446744073709551616", "0..18446744073709551615"}) {
    CAPTURE(list);
    const std::string message = test::error_message([&] { seeds_from(list); });
    CHECK(test::one_line_with(message, "--seeds", fmt::format("'{}'", list)));
  }
}

}  // namespace hqslam::tools
