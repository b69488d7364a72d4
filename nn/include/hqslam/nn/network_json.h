#pragma once

#include <string>

#include "hqslam/nn/architectures.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

/// A network's description as JSON, as it stands in weights files and training configurations.
/// Reading: "sensor" is a preset's name or an object as in sensor files; "measured_rows" a number
/// of rows (16) or {"offset": 3, "stride": 4}; missing fields have NetworkDescription's values;
/// unknown ones are refused. Throws Error with `source`, field, expected, found.
NetworkDescription network_from_json(const std::string& text, const std::string& source,
                                     const Architectures& architectures = hqs_architectures());
std::string network_json(const NetworkDescription& description);

}  // namespace hqslam::nn
