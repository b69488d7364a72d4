#pragma once

#include <string>

namespace hqslam {

/// Throws Error if a JSON text nests its values deeper than 32 or gives one object more than 1000
/// fields: values are written and copied by recursion, and an object whose fields keep their order
/// is read by comparing each name with all before it. A text that is not JSON passes; its parser
/// reports what is wrong. `source` stands for the file in messages.
void check_json_limits(const std::string& text, const std::string& source);

}  // namespace hqslam
