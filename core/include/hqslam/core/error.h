#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace hqslam {

/// Wrong input: a file, a shape or an option. The message is one line: what was expected, what was
/// found and how to mend it. Numerical trouble is not an Error but a status in a result.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  /// A message as fmt::format takes it.
  template <typename... Values>
  explicit Error(fmt::format_string<Values...> message, Values&&... values)
      : std::runtime_error(fmt::format(message, std::forward<Values>(values)...)) {}
};

/// One scan of a recording that cannot be read: it is left out, and reading goes on with the next
/// one.
class ScanError : public Error {
 public:
  using Error::Error;
};

}  // namespace hqslam
