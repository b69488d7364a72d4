#include "report/page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report/chart.h"
#include "report/cloud_picture.h"

namespace hqslam::tools {

std::string markdown_of(const TextTable& table) {
  const auto line_of = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::vector<std::string> rule(table.columns.size(), "---:");
  rule.front() = "---";
  std::string text = line_of(table.columns) + line_of(rule);
  for (const std::vector<std::string>& row : table.rows) text += line_of(row);
  return text;
}

std::string aligned_text(const TextTable& table) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text += i == 0 ? fmt::format("{:<18}", cells[i]) : fmt::format(" {:>13}", cells[i]);
    }
    text += "\n";
  };
  add(table.columns);
  for (const std::vector<std::string>& row : table.rows) add(row);
  return text;
}

std::string figure_text(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : kNoFigure;
}

namespace {

constexpr std::string_view kReportStyle = R"css(
:root {
  color-scheme: light dark;
  --page: #ffffff; --text: #1c1f24; --quiet: #666d78; --rule: #e3e6ea; --panel: #f6f7f9;
  --reference: #1c1f24; --estimate: #2c5cd4; --notice: #fff3dc; --notice-text: #6b4700;
  --reading: #aeb4bd; --upsampling: #c9564a; --segmentation: #4a78c8; --features: #3f9e8c;
  --odometry: #e2a33c; --mapping: #b4588f; --loops: #6f5bb5;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #14171b; --text: #e4e7eb; --quiet: #99a1ad; --rule: #2c3138; --panel: #1c2026;
    --reference: #e4e7eb; --estimate: #7ea2ff; --notice: #3a2d12; --notice-text: #f3d9a4;
    --reading: #6d7480; --upsampling: #dd7264; --segmentation: #5f8bd6; --features: #4fb09d;
    --odometry: #d9a04a; --mapping: #c270a2; --loops: #8d7bd0;
  }
  .plot .map { filter: invert(1); mix-blend-mode: screen; }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 2rem 1rem 4rem; max-width: 62rem;
  background: var(--page); color: var(--text);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif;
}
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 .25rem; font-weight: 650; }
h2 { font-size: 1.1rem; margin: 2.75rem 0 .5rem; font-weight: 650; }
p { margin: .25rem 0 .75rem; }
.quiet { color: var(--quiet); overflow-wrap: anywhere; }
.notice {
  background: var(--notice); color: var(--notice-text); border-radius: 6px;
  padding: .6rem .9rem; margin: 1rem 0; overflow-wrap: anywhere;
}
.numbers {
  display: grid; grid-template-columns: repeat(auto-fit, minmax(8.5rem, 1fr));
  gap: .75rem; margin: 1.5rem 0 0; padding: 0;
}
.numbers div { background: var(--panel); border-radius: 8px; padding: .65rem .8rem; }
.numbers dt { color: var(--quiet); font-size: .85rem; }
.numbers dd { margin: 0; font-size: 1.5rem; line-height: 1.25; font-weight: 600; }
.numbers dd small { font-size: .95rem; font-weight: 500; }
.numbers dd.note { font-size: .8rem; font-weight: 400; color: var(--quiet); }
.legend {
  list-style: none; display: flex; flex-wrap: wrap; gap: .25rem 1.1rem;
  margin: 0 0 .5rem; padding: 0; font-size: .85rem;
}
.legend li { display: flex; align-items: center; gap: .4rem; }
.legend i { width: .8rem; height: .8rem; border-radius: 2px; background: currentColor; }
.legend .scale { width: 7rem; height: .6rem; }
.legend .reference-sample {
  width: 1.6rem; height: 0; border-radius: 0; background: none;
  border-top: 2px dashed var(--reference);
}
.axis { margin: 0 0 .3rem; color: var(--quiet); font-size: .8rem; }
.axis.below { margin: 1.5rem 0 0; text-align: right; }
.plot {
  position: relative; margin-left: 2.75rem; isolation: isolate; background: var(--page);
  border-left: 1px solid var(--quiet); border-bottom: 1px solid var(--quiet);
}
.plot.chart { height: clamp(11rem, 34vw, 17rem); }
.plot svg, .plot .map { position: absolute; inset: 0; width: 100%; height: 100%; }
.plot svg { overflow: hidden; }
.plot .map { opacity: .75; }
.plot path { vector-effect: non-scaling-stroke; fill: none; }
.plot .grid { stroke: var(--quiet); stroke-opacity: .22; stroke-width: 1px; }
.plot .line { stroke-width: 2px; stroke-linejoin: round; stroke-linecap: round; }
.plot .line.estimate { stroke: var(--estimate); stroke-width: 3.5px; }
.plot .line.reference { stroke: var(--reference); stroke-width: 1.5px; stroke-dasharray: 5 4; }
.plot .line { stroke: var(--colour); }
.plot .layer { fill: var(--colour); }
i { color: var(--colour); }
.error { --colour: var(--estimate); }
.reading { --colour: var(--reading); }
.upsampling { --colour: var(--upsampling); }
.segmentation { --colour: var(--segmentation); }
.features { --colour: var(--features); }
.odometry { --colour: var(--odometry); }
.mapping { --colour: var(--mapping); }
.loops { --colour: var(--loops); }
.tick { position: absolute; font-size: .75rem; color: var(--quiet); white-space: nowrap; }
.x.tick { top: 100%; transform: translateX(-50%); padding-top: .2rem; }
.y.tick { right: 100%; transform: translateY(-50%); padding-right: .4rem; }
.mark {
  position: absolute; transform: translate(-50%, -50%); width: .8rem; height: .8rem;
  border-radius: 50%; border: 2.5px solid var(--text); background: var(--page);
}
.mark.end { background: var(--text); }
.mark b {
  position: absolute; left: .8rem; font-size: .8rem; font-weight: 600; line-height: 1;
  text-shadow: 0 0 3px var(--page), 0 0 3px var(--page), 0 0 3px var(--page);
}
.mark.start b { bottom: .7rem; }
.mark.end b { top: .7rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: .35rem .6rem; text-align: right; border-bottom: 1px solid var(--rule); }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
th { font-weight: 500; color: var(--quiet); font-size: .85rem; vertical-align: bottom; line-height: 1.25; }
.total tr:last-child td { font-weight: 600; }
h3 { font-size: 1rem; margin: 2rem 0 .4rem; font-weight: 650; }
.notes { padding-left: 1.1rem; }
figure { margin: .75rem 0; }
figure img { width: 100%; height: auto; display: block; }
figure img.rows { height: 8rem; image-rendering: pixelated; }
figcaption { color: var(--quiet); font-size: .85rem; }
)css";

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

std::string Page::text() const {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{}"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
      head_, title_, kReportStyle, style_, body_);
}

std::string picture_source(const RgbImage& image) {
  return "data:image/png;base64," + base64(encode_png(image));
}

}  // namespace hqslam::tools
