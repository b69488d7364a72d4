#include "report/page.h"

#include <fmt/format.h>

#include "report/chart.h"
#include "report/density_image.h"
#include "report/report_style.h"

namespace hqslam::tools {
namespace {

std::string row_html(const std::vector<std::string>& cells, const char* element,
                     const std::string& link) {
  std::string html = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string text = escape_html(cells[i]);
    html += i == 0 && !link.empty() ? fmt::format("<{0}><a href=\"{1}\">{2}</a></{0}>", element,
                                                  escape_html(link), text)
                                    : fmt::format("<{0}>{1}</{0}>", element, text);
  }
  return html + "</tr>\n";
}

}  // namespace

Page::Page(std::string_view title) : title_(escape_html(title)) {}

void Page::style(std::string_view css) { style_ += css; }

void Page::head_html(std::string_view html) { head_ += fmt::format("{}\n", html); }

void Page::heading(int level, std::string_view text) {
  body_ += fmt::format("<h{0}>{1}</h{0}>\n", level, escape_html(text));
}

void Page::paragraph(std::string_view text, std::string_view css_class) {
  body_ += fmt::format("<p class=\"{}\">{}</p>\n", css_class, escape_html(text));
}

void Page::numbers(const std::vector<PageNumber>& numbers) {
  body_ += "<dl class=\"numbers\">\n";
  for (const PageNumber& number : numbers) {
    body_ +=
        fmt::format("<div><dt>{}</dt><dd>{}", escape_html(number.label), escape_html(number.value));
    if (!number.unit.empty()) body_ += fmt::format(" <small>{}</small>", escape_html(number.unit));
    body_ += "</dd>";
    if (!number.note.empty()) {
      body_ += fmt::format("<dd class=\"note\">{}</dd>", escape_html(number.note));
    }
    body_ += "</div>\n";
  }
  body_ += "</dl>\n";
}

void Page::table(const TextTable& table) {
  if (table.rows.empty()) return;
  if (!table.title.empty()) heading(3, table.title);
  body_ += "<div class=\"scroll\"><table>" + row_html(table.columns, "th", "");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    body_ += row_html(table.rows[i], "td", table.links.empty() ? "" : table.links[i]);
  }
  body_ += "</table></div>\n";
}

void Page::list(const std::vector<std::string>& items) {
  body_ += "<ul class=\"notes quiet\">\n";
  for (const std::string& item : items) body_ += fmt::format("<li>{}</li>\n", escape_html(item));
  body_ += "</ul>\n";
}

void Page::picture(const RgbImage& image, std::string_view caption, bool rows) {
  body_ +=
      fmt::format("<figure><img alt=\"{0}\"{1} src=\"{2}\"><figcaption>{0}</figcaption></figure>\n",
                  escape_html(caption), rows ? " class=\"rows\"" : "", picture_source(image));
}

std::string Page::text() const { return page_html(title_, style_, body_, head_); }

std::string picture_source(const RgbImage& image) {
  return "data:image/png;base64," + base64(encode_png(image));
}

}  // namespace hqslam::tools
