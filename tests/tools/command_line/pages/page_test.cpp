#include "report/page.h"

#include <doctest/doctest.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/parts_of_text.h"

namespace hqslam::tools {

TEST_CASE("a page shows what is given as text, and takes none of it for markup") {
  const std::string hostile = "<b>&\"";
  Page page(hostile);
  page.heading(1, hostile);
  page.paragraph(hostile);
  page.numbers({{hostile, hostile, hostile, hostile}});
  page.table({.title = hostile, .columns = {hostile}, .rows = {{hostile}}, .links = {hostile}});
  page.list({hostile});
  page.picture(RgbImage{1, 1, {{1, 2, 3}}}, hostile);
  const std::string html = page.text();
  CHECK_FALSE(holds(html, hostile));
  CHECK(count(html, "&lt;b&gt;") == 14);
  CHECK(html.starts_with("<!doctype html>"));
  CHECK(html.ends_with("</html>\n"));
}

TEST_CASE("style and head of a page come where a browser looks for them") {
  Page page("title");
  page.style("b { color: red; }");
  page.head_html("<meta name=\"generator\" content=\"x\">");
  page.html("<svg></svg>");
  const std::string html = page.text();
  CHECK(html.find("<meta name=\"generator\"") < html.find("<title>title</title>"));
  CHECK(html.find("b { color: red; }</style>") < html.find("</head>"));
  CHECK(html.find("<svg></svg>") > html.find("<body>"));
}

TEST_CASE("a table without rows is not shown, one without a title has none") {
  Page page("title");
  page.table({.title = "Nothing", .columns = {"a"}});
  CHECK_FALSE(holds(page.text(), "Nothing"));
  page.table({.columns = {"a"}, .rows = {{"1"}}});
  CHECK_FALSE(holds(page.text(), "<h3>"));
  CHECK(holds(page.text(), "<tr><th>a</th></tr>\n<tr><td>1</td></tr>"));
}

TEST_CASE("figures become cells of a table and fields of a file; what a row lacks is missing") {
  struct Row {
    double share;
    std::optional<double> lost;
  };
  const std::vector<Figure<Row>> figures = {
      {"share, %", "share", 1, 100.0, [](const Row& row) { return row.share; }},
      {"lost", "lost", 2, 1.0, [](const Row& row) { return row.lost; }},
      {nullptr, "twice", 0, 1.0, [](const Row& row) { return 2.0 * row.share; }}};
  const TextTable table = table_of(std::vector<Row>{{0.25, 3.0}, {0.5, std::nullopt}}, "row",
                                   figures, [](const Row& row) { return row.lost ? "a" : "b"; });
  CHECK(
      markdown_of(table) ==
      "| row | share, % | lost |\n| --- | ---: | ---: |\n| a | 25.0 | 3.00 |\n| b | 50.0 | - |\n");
  CHECK(aligned_text(table).starts_with("row                     share, %          lost\na "));
  CHECK(holds(aligned_text({.columns = {"", "fourteen chars", "fourteen chars"}}), "chars four"));
  std::map<std::string, double> fields;
  add_figures(Row{0.5, std::nullopt}, figures, fields);
  CHECK(fields == std::map<std::string, double>{{"share", 0.5}, {"twice", 1.0}});
}

}  // namespace hqslam::tools
