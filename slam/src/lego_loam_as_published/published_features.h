#pragma once

#include <vector>

#include "segmented_scan.h"

namespace hqslam::slam::as_published {

/// Features in the order of their rows, from the lowest.
struct PublishedFeatures {
  std::vector<FeaturePoint> sharp;
  std::vector<FeaturePoint> less_sharp;  ///< the sharp ones included
  std::vector<FeaturePoint> flat;        ///< of the ground
  std::vector<FeaturePoint> less_flat;   ///< what is no edge, ground and clusters, thinned by row
};

/// LeGO-LOAM's feature association, first half.
///
/// With ranges r along the kept points, c_i = (sum over the 10 neighbours of r_j - 10 r_i)^2, in
/// m^2 whatever the range. Points behind a depth jump of 0.3 m and points whose neighbours differ
/// by more than 2 % of the range are passed over. Of each of six sections of a row: 2 sharp and 20
/// less sharp edges, c > 0.1, off the ground; 4 flat points of the ground, c < 0.1; chosen ones
/// keep five neighbours on each side from being chosen, but the fourth flat one does not. The sort
/// leaves out the last point of a section.
PublishedFeatures published_features(const SegmentedScan& scan);

}  // namespace hqslam::slam::as_published
