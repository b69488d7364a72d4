#pragma once

#include <string>

namespace hqslam {

/// Throws Error if a JSON text nests its values deeper than 32 or gives one object more than 1000
/// fields: who writes or copies a value calls itself once per level, and who reads an object whose
/// fields keep their order compares each name with all before it. A text that is no JSON passes;
/// what parses it says what is wrong with it. `source` stands for the file in messages.
void check_json_limits(const std::string& text, const std::string& source);

}  // namespace hqslam
