#include "program/help_formatter.h"

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
  constexpr std::size_t kRight = HelpFormatter::kWidth - kOfGroup;
  std::string left = "  " + broken(name, 6, 2, kRight);
  if (explanation.empty()) return left + '\n';
  const bool fits = left.size() + 2 <= kColumn && left.find('\n') == std::string::npos;
  left += fits ? std::string(kColumn - left.size(), ' ') : '\n' + std::string(kColumn, ' ');
  return left + broken(explanation, kColumn, kColumn, kRight) + '\n';
}

/// A list "{a,b,c}" with spaces after its commas, where a line can end.
std::string spaced(const std::string& list) {
  std::string result;
  for (const char c : list) result += c == ',' ? std::string(", ") : std::string(1, c);
  return result;
}

}  // namespace

std::string filled(const std::string& text) {
  std::istringstream lines(text);
  std::string result, paragraph;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) result += broken(paragraph, 0, 0, HelpFormatter::kWidth) + '\n';
    paragraph.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.front() != ' ') {
      paragraph += line + ' ';
      continue;
    }
    end_paragraph();
    result += line + '\n';
  }
  end_paragraph();
  return result;
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
