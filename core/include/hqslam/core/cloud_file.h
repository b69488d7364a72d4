#pragma once

#include <string>

#include "hqslam/core/scan.h"

namespace hqslam {

/// Writes the points of a scan with what is known of each, binary: .pcd and .ply with fields x y z,
/// intensity, ring (0 the highest beam), timestamp (seconds) and confidence; .las as version 1.2,
/// coordinates to the millimetre, point format 1, or 0 without times, what has no place in it in
/// extra bytes of these names. LAS has whole numbers of 16 bits for intensities: up to 1 they are
/// multiplied by 65,535, up to 255 by 257, from 65,536 on made to fit; one that is not known is 0.
/// The name's ending says which it is. Throws Error for another one, and if there are not as many
/// of something as points. Source of LAS: ASPRS, "LAS specification", 1.2 and 1.4 R15.
void write_cloud(const Scan& scan, const std::string& path);

}  // namespace hqslam
