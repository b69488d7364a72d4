#pragma once

#include <nlohmann/json.hpp>

#include "hqslam/core/json_fields.h"
#include "hqslam/nn/hqs/outlier_removal.h"

namespace hqslam::nn {

/// Replaces what the object `field` names; nothing if there is no such field.
void read_filter(JsonFields& fields, const char* field, OutlierRemovalOptions& filter);
nlohmann::ordered_json filter_json(const OutlierRemovalOptions& filter);

}  // namespace hqslam::nn
