#include "program/help_formatter.h"

#include <algorithm>
#include <sstream>

namespace hqslam::tools {
namespace {

constexpr std::size_t kColumn = 28;  ///< of the explanations

/// The words of a text, each line but the first indented. column: where the first line begins.
std::string broken(const std::string& text, std::size_t indent, std::size_t column,
                   std::size_t width) {
  std::istringstream words(text);
  std::string result;
  std::size_t at = column;
  bool is_first = true;
  for (std::string word; words >> word;) {
    if (!is_first && at + 1 + word.size() > width) {
      result += '\n' + std::string(indent, ' ');
      at = indent;
    } else if (!is_first) {
      result += ' ';
      ++at;
    }
    result += word;
    at += word.size();
    is_first = false;
  }
  return result;
}

/// A name and its explanation, side by side or, where the name is long, below each other.
std::string entry(const std::string& name, const std::string& explanation) {
  constexpr std::size_t kOfGroup = 2;  // by which CLI11 indents the options of a group
  std::string left = "  " + broken(name, 6, 2, HelpFormatter::kWidth - kOfGroup);
  if (explanation.empty()) return left + '\n';
  const bool fits = left.size() + 2 <= kColumn && left.find('\n') == std::string::npos;
  left += fits ? std::string(kColumn - left.size(), ' ') : '\n' + std::string(kColumn, ' ');
  return left + broken(explanation, kColumn, kColumn, HelpFormatter::kWidth) + '\n';
}

/// A list "{a,b,c}" with spaces after its commas, where a line can end.
std::string spaced(const std::string& list) {
  std::string result;
  for (const char c : list) result += c == ',' ? std::string(", ") : std::string(1, c);
  return result;
}

/// Lines that belong together: a text, or a name and its explanation, whose further lines are
/// indented deeper.
class Paragraph {
 public:
  void begin(std::size_t indent, const std::string& line) {
    is_open_ = true;
    indent_ = indent;
    text_ = line.substr(indent);
    const std::size_t gap = text_.find("  ");  // between a name and its explanation
    hang_ = indent + (gap == std::string::npos ? 0 : text_.find_first_not_of(' ', gap));
  }
  bool is_continued_by(std::size_t indent, const std::string& line) const {
    if (!is_open_ || line.empty() || text_.empty()) return false;
    return indent_ == 0 ? indent == 0 : indent > indent_;
  }
  void add(std::size_t indent, const std::string& line) {
    hang_ = indent;
    text_ += ' ' + line.substr(indent);
  }
  /// It, in lines, and nothing left of it.
  std::string taken(std::size_t width) {
    if (!is_open_) return "";
    is_open_ = false;
    if (indent_ + text_.size() <= width) return std::string(indent_, ' ') + text_ + '\n';
    // The name stays apart from its explanation by as many spaces as it was.
    const std::size_t name = hang_ - indent_;
    const bool has_name = name > 0 && name < text_.size() && text_[name - 1] == ' ';
    const std::string left = std::string(indent_, ' ') + (has_name ? text_.substr(0, name) : "");
    return left + broken(has_name ? text_.substr(name) : text_, hang_, left.size(), width) + '\n';
  }

 private:
  bool is_open_ = false;
  std::size_t indent_ = 0;
  std::size_t hang_ = 0;  ///< of its further lines
  std::string text_;
};

}  // namespace

std::string filled(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  std::string result;
  Paragraph paragraph;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    if (!paragraph.is_continued_by(indent, line)) {
      result += paragraph.taken(width);
      paragraph.begin(indent, line);
      continue;
    }
    paragraph.add(indent, line);
  }
  return result + paragraph.taken(width);
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  return entry(make_option_name(option, is_positional) + spaced(make_option_opts(option)),
               make_option_desc(option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* subcommand) const {
  return entry(subcommand->get_display_name(true), subcommand->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return filled(CLI::Formatter::make_description(app));
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  return filled(app->get_footer());
}

}  // namespace hqslam::tools
