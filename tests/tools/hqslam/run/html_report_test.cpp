#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include "run/run_output.h"
#include "tools/example_run.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

/// Whether every opened element of `name` is closed.
bool balanced(const std::string& html, const std::string& name) {
  const std::regex opening("<" + name + "[ >]");
  const std::regex closing("</" + name + ">");
  const auto count = [&](const std::regex& tag) {
    return std::distance(std::sregex_iterator(html.begin(), html.end(), tag),
                         std::sregex_iterator());
  };
  return count(opening) == count(closing);
}

}  // namespace

TEST_CASE("the report needs no other file and no network") {
  const std::string html = html_report(compared_run(30, 0.5));
  CHECK_FALSE(
      std::regex_search(html, std::regex("(src|href|url)\\s*[=(]\\s*[\"']?(?!data:)[a-z./]")));
  CHECK_FALSE(holds(html, "@import"));
  CHECK_FALSE(holds(html, "fetch("));
}

TEST_CASE("the headline says scans, path, error with its alignment, and speed") {
  const SlamRun run = compared_run(30, 0.5);
  REQUIRE(run.comparison);
  const std::string html = html_report(run);
  CHECK(missing(html, {"<dd>30</dd>", "29.0 <small>m</small>", "SE(3)-aligned", "<dd>50.0</dd>",
                       "10.0 <small>ms</small>"}) == "");
}

TEST_CASE(
    "where nothing is known about the way there is no line and no path, parts joined or not") {
  SlamRun run = example_run(30);
  const auto lines = [](const std::string& html) {
    const std::regex line("class=\"line estimate\"");
    return std::distance(std::sregex_iterator(html.begin(), html.end(), line), {});
  };
  CHECK(lines(html_report(run)) == 1);
  std::fill(run.segment_of_scan.begin() + 10, run.segment_of_scan.end(), 1);
  run.scans[20].report.mapping_status = slam::Status::kNotRecognized;
  const std::string html = html_report(run);
  CHECK(lines(html) == 3);
  CHECK(holds(html, "26.0 <small>m</small>"));  // of 29, one to stretch 1, two about scan 20
  CHECK_FALSE(holds(html, "parts not joined"));
  run.part_of_scan = run.segment_of_scan;
  CHECK(lines(html_report(run)) == 3);
  CHECK(holds(html_report(run), "2 parts not joined"));
  CHECK(holds(html, "<th>not recognized</th>"));
}

TEST_CASE("every element of the report is closed, with and without a reference") {
  for (const SlamRun& run : {compared_run(30, 0.5), example_run(30)}) {
    const std::string html = html_report(run);
    for (const char* name : {"div", "svg", "span", "table", "tr", "td", "th", "p", "dl", "dd", "dt",
                             "ul", "li", "h2", "b", "small", "i"}) {
      CAPTURE(name);
      CHECK(balanced(html, name));
    }
  }
}

TEST_CASE("a run that ended early says why, and a hostile file name stays text") {
  SlamRun run = example_run(3);
  run.input = "<img>alert";
  run.end = ReadingEnd::kUnreadableScan;
  run.end_message = "<000003.bin>: truncated";
  const std::string html = html_report(run);
  CHECK(missing(html, {"&lt;000003.bin&gt;: truncated", "&lt;img&gt;alert"}) == "");
  CHECK_FALSE(holds(html, "<img>"));
}

TEST_CASE("a run without a single scan still makes a page without infinite numbers") {
  SlamRun run = example_run(0);
  run.end = ReadingEnd::kInterrupted;
  const std::string html = html_report(run);
  CHECK(holds(html, "</html>"));
  CHECK_FALSE(std::regex_search(html, std::regex("[ ,:\">-](nan|inf)[ ,<\"%]")));
}

TEST_CASE("a long run is binned: its chart of times does not grow with the drive") {
  const std::string html = html_report(example_run(8000));
  CHECK(holds(html, "means of 20 scans"));
  CHECK(html.size() < 600'000);
}

TEST_CASE("the estimate is coloured by its error where there is a reference") {
  const SlamRun run = compared_run(30, 2.0);
  REQUIRE(run.comparison);
  const std::string html = trajectory_plot_html(run);
  const std::regex stroke("stroke:(#[0-9a-f]{6})");
  const std::set<std::string> colors(
      std::sregex_token_iterator(html.begin(), html.end(), stroke, 1), {});
  CHECK(colors.size() >= 2);
  CHECK(holds(html, "line reference"));
}

TEST_CASE("a reference in another frame is drawn over the estimate, not beside it") {
  const SlamRun run = compared_run(30, 0.0);
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
  const std::string html = trajectory_plot_html(example_run(30));
  CHECK_FALSE(holds(html, "line reference"));
  CHECK_FALSE(holds(html, "stroke:#"));
  CHECK(html.find("class=\"line estimate\"") == html.rfind("class=\"line estimate\""));
}

TEST_CASE("both axes have one scale: the box is as wide in metres as it is drawn") {
  // 29 m along x, margins of 12 m: 53 m x 24 m.
  const std::string html = trajectory_plot_html(example_run(30));
  CHECK(holds(html, "aspect-ratio:2.2083"));
}

}  // namespace hqslam::tools
