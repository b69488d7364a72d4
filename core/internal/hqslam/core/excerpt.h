#pragma once

#include <string>
#include <string_view>

namespace hqslam {

/// The beginning of a text that comes from a file, a name or the network, fit for a message of one
/// line: control characters and bytes that are no UTF-8 are shown as \n, \t, \r or \x1b, so that
/// they cannot steer a terminal, and "..." stands for what is beyond `max_characters`.
std::string excerpt(std::string_view text, std::size_t max_characters = 30);

/// Bytes of the UTF-8 character that a text begins with, which is not empty; 0 if it begins with
/// none. Overlong forms of three bytes and more and surrogates pass.
std::size_t utf8_bytes(std::string_view text);

}  // namespace hqslam
