#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/lego_loam/lego_loam.h"
#include "points.h"
#include "segmentation.h"

namespace hqslam::lego_loam {

/// Points in the order of their rows. The paper's sets are F_e (sharp, and less sharp for all
/// edges) and F_p (flat, and less flat for all planar points).
struct Features {
  Cloud sharp;
  Cloud less_sharp;               ///< with the sharp ones
  Cloud flat;                     ///< of the ground
  Cloud less_flat_ground;         ///< thinned row by row, with the flat ones
  Cloud less_flat_cluster;        ///< thinned row by row
  std::vector<FeatureKind> kind;  ///< per pixel
};

/// Section III-C. In: the points that segmentation kept, row by row.
///
/// With ranges r along a row, the smoothness of point i is
///   c = (sum over the 5 points on either side of (r_j - r_i))^2.
/// Points behind the edge of something nearer (a jump of 0.3 m between neighbouring columns) and
/// points on surfaces that a beam grazes (both neighbours off by 2 % of the range) are passed over.
/// Each row is cut into six sections. Of a section the points with the largest c that are above 0.1
/// m^2 and no ground are edges, 2 sharp and up to 20 less sharp; the points with the smallest c
/// that are below 0.1 m^2 and ground are planar features, up to 4. A chosen point
/// suppresses the 5 points on either side. All points that are no edges are less flat.
///
/// Differs from LeGO-LOAM: the paper divides c by 10 r, its program, whose threshold holds here,
/// does not, and the paper takes 40 less sharp and 80 less flat ones. The program leaves out
/// the last point of a section when it sorts, lets the fourth flat point suppress no neighbours,
/// and begins a row a point too early. Ground and clusters are thinned apart (0.2 m), since
/// odometry matches labels.
Features extract_features(const SegmentedScan& scan, int columns);

}  // namespace hqslam::lego_loam
