#include "../../core/src/natural_order.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using hqslam::naturally_before;

TEST_CASE("numbers inside names count by their value") {
  const std::vector<std::string> ordered = {"",
                                            "0001",
                                            "01",
                                            "1",
                                            "2",
                                            "10",
                                            "a1.bin",
                                            "a9.bin",
                                            "a10.bin",
                                            "a10b2",
                                            "a10b10",
                                            "b",
                                            "scan99999999999999999999",
                                            "scan100000000000000000000"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      CAPTURE(ordered[i]);
      CAPTURE(ordered[j]);
      CHECK(naturally_before(ordered[i], ordered[j]) == (i < j));
    }
  }
}
