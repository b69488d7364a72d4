#include "program/invocation.h"

#include <string_view>

namespace hqslam::tools {
namespace {

std::string& kept() {
  static std::string invocation;
  return invocation;
}

}  // namespace

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,:=+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + '\'';
}

void keep_invocation(const std::string& program, int argc, const char* const* argv) {
  kept() = program;
  for (int i = 1; i < argc; ++i) kept() += ' ' + shell_word(argv[i]);
}

const std::string& invocation() { return kept(); }

}  // namespace hqslam::tools
