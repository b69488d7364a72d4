#include "table/table_report.h"

#include <fmt/format.h>

#include "pages/page.h"
#include "printing/printed_table.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

void add(std::string& text, const char* level, const TextTable& table) {
  if (table.rows.empty()) return;
  text += fmt::format("{} {}\n\n{}\n", level, table.title, markdown_of(table));
}

Json tables_json(const std::vector<TextTable>& tables) {
  Json json = Json::array();
  for (const TextTable& table : tables) json.push_back(json_of(table));
  return json;
}

}  // namespace

std::string printed(const TableReport& report) {
  std::string text;
  for (const TextTable& table : report.lead.empty() ? report.parts.front().tables : report.lead) {
    text += fmt::format("{}\n\n{}\n", table.title, printed_table(table));
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

std::string html_of(const TableReport& report) { return page_html("table", page_data(report)); }

Json page_data(const TableReport& report) {
  Json parts = Json::array();
  for (const ReportPart& part : report.parts) {
    parts.push_back({{"title", part.title},
                     {"text", part.text},
                     {"tables", tables_json(part.tables)},
                     {"error_maps", part.error_maps},
                     {"paired_with", part.paired_with},
                     {"paired_drifts", part.paired_drifts}});
  }
  return {{"title", report.title},
          {"lead", tables_json(report.lead)},
          {"parts", std::move(parts)},
          {"notes", report.notes}};
}

}  // namespace hqslam::tools
