#include "run/trajectory_plot.h"

#include <doctest/doctest.h>

#include <regex>
#include <set>
#include <string>

#include "tools/example_run.h"

namespace hqslam::tools {

TEST_CASE("the estimate is coloured by its error where there is a reference") {
  const SlamRun run = test::compared_run(30, 2.0);
  REQUIRE(run.comparison);
  const std::string html = trajectory_plot_html(run);
  const std::regex stroke("stroke:(#[0-9a-f]{6})");
  const std::set<std::string> colors(
      std::sregex_token_iterator(html.begin(), html.end(), stroke, 1), {});
  CHECK(colors.size() >= 2);
  CHECK(html.find("line reference") != std::string::npos);
}

TEST_CASE("a reference in another frame is drawn over the estimate, not beside it") {
  const SlamRun run = test::compared_run(30, 0.0);
  REQUIRE(run.comparison);
  const std::string html = trajectory_plot_html(run);
  const auto path_of = [&](const std::string& line) {
    const std::size_t begin = html.find("d=\"M", html.find(line));
    return html.substr(begin, html.find('"', begin + 3) - begin);
  };
  const std::string reference = path_of("line reference");
  const std::string estimate = path_of("line estimate");
  CHECK(reference.size() > 100);
  CHECK(reference.substr(0, 24) == estimate.substr(0, 24));
}

TEST_CASE("without a reference the estimate is one line of one colour") {
  const std::string html = trajectory_plot_html(test::example_run(30));
  CHECK(html.find("line reference") == std::string::npos);
  CHECK(html.find("stroke:#") == std::string::npos);
  CHECK(html.find("class=\"line estimate\"") == html.rfind("class=\"line estimate\""));
}

TEST_CASE("both axes have one scale: the box is as wide in metres as it is drawn") {
  // 29 m along x, margins of 12 m: 53 m x 24 m.
  const std::string html = trajectory_plot_html(test::example_run(30));
  CHECK(html.find("aspect-ratio:2.2083") != std::string::npos);
}

}  // namespace hqslam::tools
