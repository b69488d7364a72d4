#include "laboratory/table/table_report.h"

#include <fmt/format.h>

#include <string_view>

#include "report/page.h"

namespace hqslam::tools {
namespace {

/// What the tables' pages add to the reports' style: they are wider.
constexpr std::string_view kPageStyle = R"css(
body { max-width: 84rem; }
h2 { font-size: 1.3rem; margin-top: 3.5rem; }
td { white-space: nowrap; }
.tables { display: grid; gap: 0 3rem; grid-template-columns: repeat(auto-fit, minmax(min(36rem, 100%), 1fr)); }
)css";

void add(std::string& text, const char* level, const TextTable& table) {
  if (table.rows.empty()) return;
  text += fmt::format("{} {}\n\n{}\n", level, table.title, markdown_of(table));
}

}  // namespace

std::string picture_name(const std::string& drive, std::size_t loop_closing) {
  return fmt::format("{}-loop-closing-{}.svg", drive, kLoopClosingNames[loop_closing]);
}

std::string printed(const TableReport& report) {
  std::string text;
  for (const TextTable& table : report.lead.empty() ? report.parts.front().tables : report.lead) {
    text += fmt::format("{}\n\n{}\n", table.title, markdown_of(table));
  }
  return text;
}

std::string markdown_of(const TableReport& report) {
  std::string text;
  for (const TextTable& table : report.lead) add(text, "##", table);
  for (const ReportPart& part : report.parts) {
    text += fmt::format("## {}\n\n{}\n\n", part.title, part.text);
    for (const TextTable& table : part.tables) add(text, "###", table);
  }
  text += "## Notes\n\n";
  for (const std::string& note : report.notes) text += fmt::format("- {}\n", note);
  return text;
}

std::string html_of(const TableReport& report) {
  Page page("hqslam table");
  page.style(kPageStyle);
  page.style(report.style);
  page.heading(1, report.title);
  page.html("<div class=\"tables\">\n");
  for (const TextTable& table : report.lead) {
    page.html("<div>");
    page.table(table);
    page.html("</div>\n");
  }
  page.html("</div>\n");
  for (const ReportPart& part : report.parts) {
    page.heading(2, part.title);
    page.paragraph(part.text + part.page_text);
    for (const TextTable& table : part.tables) page.table(table);
    page.html(part.figures_html);
  }
  page.heading(2, "Notes");
  page.list(report.notes);
  return page.text();
}

}  // namespace hqslam::tools
