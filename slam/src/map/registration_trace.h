#pragma once

#include "hqslam/slam/scan_trace.h"
#include "map/mapping.h"

namespace hqslam::slam {

/// Writes down with what of the map each feature of a scan is matched at the pose that was found,
/// and the information of the matches: one more search, of the reach of the last one.
void trace_registration(const Mapping& mapping, const MapFeatures& features,
                        const MappingResult& found, ScanTrace& trace);

/// The same of a scan that is not registered: its features alone.
void trace_features(const MapFeatures& features, ScanTrace& trace);

}  // namespace hqslam::slam
