#pragma once

#include <vector>

#include "front_end/features.h"
#include "front_end/segmentation.h"
#include "hqslam/core/organized_cloud.h"

namespace hqslam::slam {

/// What a row sees of narrow things that stand alone: trunks, posts, bushes.
///
/// In: a scan, its segmentation, one of its rows. Returns, ordered by column, one point for each
/// run of neighbouring columns without ground whose ranges differ by at most 0.3 m from one to the
/// next, that is at most max_width_m wide, and on both sides of which the row goes on behind it (by
/// more than 0.3 m, or for ever): its middle, if it is round, captured when the middle column was,
/// and as bright as that.
///
///   middle = mean of the points + (pi / 8) width * direction of the beam
///
/// because the mean of the half of a circle that faces the sensor lies pi/4 of its radius before
/// its middle. Without this a post seems to move along as the sensor passes, and holds it back.
/// What is cut off by something nearer has its middle elsewhere and is left out, and so is what
/// lies at the image's seam.
///
/// LeGO-LOAM has none: its edges need five columns on both sides, and segmentation takes what is
/// smaller than 30 pixels for clutter. In open land that is all there is: of 70 things that 16 rows
/// see there in a scan, half are one or two columns wide.
std::vector<FeaturePoint> posts_in_row(const OrganizedCloud& cloud,
                                       const Segmentation& segmentation, int row,
                                       double max_width_m);

}  // namespace hqslam::slam
