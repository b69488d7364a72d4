#include "report/error_color.h"

#include <doctest/doctest.h>

namespace hqslam::tools {

TEST_CASE("the largest error has the last colour of the scale and no error the first") {
  CHECK(error_color(0.0) == "#2c5cd4");
  CHECK(error_color(1.0) == "#fa9628");
  CHECK(error_color(7.0) == error_color(1.0));
  CHECK(error_color(1.0 / 3.0) == "#9242c4");
}

TEST_CASE("errors fall into as many classes as there are colours, the largest into the last") {
  CHECK(error_color_class(0.0) == 0);
  CHECK(error_color_class(-1.0) == 0);
  CHECK(error_color_class(0.51) == kErrorColors / 2);
  CHECK(error_color_class(1.0) == kErrorColors - 1);
  CHECK(error_color_class(7.0) == kErrorColors - 1);
  CHECK(error_color_of_class(0) == error_color(0.5 / kErrorColors));
}

TEST_CASE("the gradient goes from the first colour to the last") {
  CHECK(error_gradient().rfind("#2c5cd4, ", 0) == 0);
  CHECK(error_gradient().substr(error_gradient().size() - 9) == ", #fa9628");
}

}  // namespace hqslam::tools
