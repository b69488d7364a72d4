#include "hqslam/nn/training/training_scans.h"

#include <doctest/doctest.h>

#include "error_message.h"
#include "small_training.h"

namespace hqslam::nn {

TEST_CASE("scans in memory are of one shape and numbered from 0") {
  const auto message = [](std::vector<RangeImage> with, std::int64_t scan) {
    return test::error_message([&] { return ScansInMemory(std::move(with)).read(scan); });
  };
  CHECK(ScansInMemory(scans()).read(2).range_m == scans()[2].range_m);
  CHECK(test::one_line_with(message({RangeImage(16, 32), RangeImage(8, 32)}, 0), "8 x 32",
                            "16 x 32"));
  CHECK(test::one_line_with(message(scans(), 3), "scan 3", "0 to 2"));
  CHECK(test::one_line_with(message(scans(), -1), "scan -1", "0 to 2"));
}

}  // namespace hqslam::nn
