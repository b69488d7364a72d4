#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hqslam/evaluation/png.h"
#include "report/text_table.h"

namespace hqslam::tools {

/// A headline number of a page.
struct PageNumber {
  std::string label;
  std::string value;
  std::string unit = {};
  std::string note = {};
};

/// A page in the style of all reports, for light and dark, phone and desktop, that needs no other
/// file and no network; written from its top to its bottom. What is given is text, of which nothing
/// is taken for markup, unless the name says html.
class Page {
 public:
  /// title: of the window.
  explicit Page(std::string_view title);

  /// Adds to the reports' style.
  void style(std::string_view css);
  /// Adds to the page's head.
  void head_html(std::string_view html);
  /// level: 1, 2 or 3.
  void heading(int level, std::string_view text);
  void paragraph(std::string_view text, std::string_view css_class = "quiet");
  void numbers(const std::vector<PageNumber>& numbers);
  /// With its title, if it has one; nothing where it has no rows.
  void table(const TextTable& table);
  void list(const std::vector<std::string>& items);
  /// rows: of an image of ranges, which is flat: it is stretched and its pixels stay squares.
  void picture(const RgbImage& image, std::string_view caption, bool rows = false);
  /// A chart or another figure that is markup already.
  void html(std::string_view html) { body_ += html; }

  /// The whole page.
  std::string text() const;

 private:
  std::string title_;
  std::string style_;
  std::string head_;
  std::string body_;
};

/// A picture as the source of an <img>.
std::string picture_source(const RgbImage& image);

}  // namespace hqslam::tools
