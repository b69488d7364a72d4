#include "hqslam/core/nearest_names.h"

#include "testing.h"

namespace hqslam {

TEST_CASE("a mistyped name has the nearest names, those that hold it first") {
  const std::vector<std::string> names{"os1-64", "os1-16", "vlp-16", "hdl-64e"};
  CHECK(did_you_mean("os1", names) == "; did you mean 'os1-64' or 'os1-16'?");
  CHECK(did_you_mean("vpl-16", names) == "; did you mean 'vlp-16'?");
  CHECK(did_you_mean("hdl64e", names) == "; did you mean 'hdl-64e'?");
  CHECK(did_you_mean("livox", names) == "");
  CHECK(did_you_mean("", names) == "");
  // A name of a megabyte is compared by its beginning.
  CHECK(did_you_mean(std::string(1 << 20, 'a'), {std::string(1 << 20, 'b')}) == "");
}

}  // namespace hqslam
