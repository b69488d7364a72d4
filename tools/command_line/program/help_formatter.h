#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

namespace hqslam::tools {

/// Help that fits a terminal of 80 columns.
class HelpFormatter : public CLI::Formatter {
 public:
  static constexpr std::size_t kWidth = 80;

  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* subcommand) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
};

/// Paragraphs in lines of at most `width` columns: lines that begin with a space stay apart, others
/// are filled up; what a line is broken into is indented as far as the line.
std::string filled(const std::string& text, std::size_t width = HelpFormatter::kWidth);

}  // namespace hqslam::tools
