#pragma once

#include <string>

#include "hqslam/core/error.h"

namespace hqslam::test {

/// The message of the Error that `call` throws; "no Error" if it throws none.
template <typename Call>
std::string error_message(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no Error";
}

/// Whether `text` is one line that holds every one of `parts`.
template <typename... Parts>
bool one_line_with(const std::string& text, const Parts&... parts) {
  return text.find('\n') == std::string::npos && (... && (text.find(parts) != std::string::npos));
}

/// Whether `call` throws an Error with such a message.
template <typename Call, typename... Parts>
bool refused_with(Call&& call, const Parts&... parts) {
  return one_line_with(error_message(call), parts...);
}

}  // namespace hqslam::test
