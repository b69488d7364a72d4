#pragma once

#include "hqslam/core/error.h"

namespace hqslam::slam {

/// Throws Error unless low <= value <= high. map: the kind of map of the option.
inline void check_option(const char* map, const char* field, double value, double low,
                         double high) {
  if (value >= low && value <= high) return;
  throw Error("{}: {} is {}, expected {} to {}", map, field, value, low, high);
}

/// A value after its validate(), which throws Error if it is invalid.
template <typename Value>
const Value& validated(const Value& value) {
  validate(value);
  return value;
}

}  // namespace hqslam::slam
