#pragma once

#include "hqslam/core/error.h"

namespace hqslam::test {

/// The message of the Error that `call` throws; "no Error" if it throws none.
std::string error_message(auto&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no Error";
}

/// Whether `text` is one line that holds every one of `parts`.
bool one_line_with(const std::string& text, const auto&... parts) {
  return text.find('\n') == std::string::npos && (... && (text.find(parts) != std::string::npos));
}

/// Whether there is one text, and it is such a line.
bool one_line_with(const std::vector<std::string>& texts, const auto&... parts) {
  return texts.size() == 1 && one_line_with(texts[0], parts...);
}

/// Whether `call` throws an Error with such a message.
bool refused_with(auto&& call, const auto&... parts) {
  return one_line_with(error_message(call), parts...);
}

}  // namespace hqslam::test
