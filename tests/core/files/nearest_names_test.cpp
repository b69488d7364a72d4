#include "hqslam/core/nearest_names.h"

#include "testing.h"

namespace hqslam {

TEST_CASE("a mistyped name has the nearest names, those that hold it first") {
  const std::vector<std::string> names{"os1-64", "os1-16", "vlp-16", "hdl-64e"};
  CHECK(nearest_names("os1", names) == std::vector<std::string>{"os1-64", "os1-16"});
  CHECK(nearest_names("vpl-16", names) == std::vector<std::string>{"vlp-16"});
  CHECK(nearest_names("hdl64e", names) == std::vector<std::string>{"hdl-64e"});
  CHECK(nearest_names("livox", names).empty());
  CHECK(nearest_names("", names).empty());
  CHECK(did_you_mean("os1", names) == "; did you mean 'os1-64' or 'os1-16'?");
  CHECK(did_you_mean("livox", names) == "");
  // A name of a megabyte is compared by its beginning.
  CHECK(nearest_names(std::string(1 << 20, 'a'), {std::string(1 << 20, 'b')}).empty());
}

}  // namespace hqslam
