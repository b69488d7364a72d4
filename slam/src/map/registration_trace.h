#pragma once

#include "hqslam/slam/scan_trace.h"
#include "map/mapping.h"

namespace hqslam::slam {

/// Records the match of each feature of a scan at the found pose, and the information of the
/// matches, by one more search with the reach of the last one.
void trace_registration(const Mapping& mapping, const MapFeatures& features,
                        const MappingResult& found, ScanTrace& trace);

/// Records the features of a scan that is not registered.
void trace_features(const MapFeatures& features, ScanTrace& trace);

}  // namespace hqslam::slam
