#include "run/covariances_csv.h"

#include <doctest/doctest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tools/example_run.h"

namespace hqslam::tools {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

}  // namespace

TEST_CASE(
    "the covariances are a line per scan: stamp, status, part and six rows of six, named above "
    "them") {
  SlamRun run = test::example_run(3);
  for (int i = 0; i < 36; ++i) run.scans[1].report.covariance(i / 6, i % 6) = 0.25 * i;
  run.scans[1].report.mapping_status = slam::Status::kTooFewFeatures;
  run.part_of_scan[1] = 2;
  const std::vector<std::string> lines = split(covariances_csv(run), '\n');
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].rfind("# covariance of e", 0) == 0);
  const std::vector<std::string> names = split(lines[1], ',');
  REQUIRE(names.size() == 39);
  CHECK(names[0] == "stamp_s");
  CHECK(names[1] == "mapping");
  CHECK(names[2] == "part");
  CHECK(names[3] == "x_x");
  CHECK(names[3 + 2 * 6 + 4] == "z_ry");
  CHECK(names[38] == "rz_rz");
  const std::vector<std::string> values = split(lines[3], ',');
  REQUIRE(values.size() == 39);
  CHECK(std::stod(values[0]) == doctest::Approx(run.scans[1].report.stamp_s));
  CHECK(values[1] == "too few features");
  CHECK(values[2] == "2");
  for (int i = 0; i < 36; ++i) CHECK(std::stod(values[i + 3]) == doctest::Approx(0.25 * i));
}

}  // namespace hqslam::tools
