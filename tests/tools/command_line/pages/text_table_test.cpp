#include "pages/text_table.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("figures become cells of a table and fields of a file; what a row lacks is missing") {
  using Row = std::pair<double, std::optional<double>>;  // share, lost
  const std::vector<Figure<Row>> figures = {
      {"share, %", "share", 1, 100.0, [](const Row& row) { return row.first; }},
      {"lost", "lost", 2, 1.0, [](const Row& row) { return row.second; }},
      {nullptr, "twice", 0, 1.0, [](const Row& row) { return 2.0 * row.first; }}};
  const TextTable table = table_of(std::vector<Row>{{0.25, 3.0}, {0.5, std::nullopt}}, "row",
                                   figures, [](const Row& row) { return row.second ? "a" : "b"; });
  CHECK(
      markdown_of(table) ==
      "| row | share, % | lost |\n| --- | ---: | ---: |\n| a | 25.0 | 3.00 |\n| b | 50.0 | - |\n");
  CHECK(printed_table(table) == "row  share, %  lost\na        25.0  3.00\nb        50.0     -\n");
  std::map<std::string, double> fields;
  add_figures(Row{0.5, std::nullopt}, figures, fields);
  CHECK(fields == std::map<std::string, double>{{"share", 0.5}, {"twice", 1.0}});
}

}  // namespace hqslam::tools
