#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hqslam {

/// "; did you mean 'os1-64' or 'os1-16'?", for the end of a message: the `names` that a mistyped
/// name may stand for, at most three, the nearest first. They are names that hold it, or, if there
/// is none, those that few edits make of it (Levenshtein's distance, a third of its letters at
/// most). Empty: none is near.
std::string did_you_mean(std::string_view mistyped, const std::vector<std::string>& names);

}  // namespace hqslam
