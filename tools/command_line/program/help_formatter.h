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

/// Lines that begin at the margin are one paragraph, broken at kWidth; indented lines and empty
/// ones stay as they are.
std::string filled(const std::string& text);

}  // namespace hqslam::tools
