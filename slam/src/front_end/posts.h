#pragma once

#include <vector>

#include "front_end/features.h"
#include "front_end/segmentation.h"
#include "hqslam/core/organized_cloud.h"

namespace hqslam::slam {

/// A post in one row.
struct Post {
  FeaturePoint centre;
  int first_column = 0;
  int last_column = 0;
};

/// Narrow objects that stand alone in a row: trunks, posts, bushes.
///
/// In: a scan, its segmentation, one of its rows. Out: one point, ordered by column, for each run
/// of neighbouring columns without ground whose ranges differ by at most 0.3 m from one to the
/// next, that is at most 1 m wide and more than 0.3 m nearer than what is on both sides of it. The
/// point is the centre of the object, if that is round, with time and intensity of the
/// middle column:
///
///   centre = mean of the points + (pi / 8) width * direction of the beam,
///   width  = distance of the outer points + range * (angle between columns - angle of the beam),
///
/// since the mean of the half circle that faces the sensor is pi/4 of the radius in front of the
/// centre, and an object answers every beam that touches it. A point on the side that faces the
/// sensor travels with it, so that paths along posts get too short: by 0.1 % if the width is that
/// of the outer points alone. Objects that something nearer occludes, or at the seam of the image,
/// are left out.
///
/// Where returns fail (has_failing_returns()), the pieces of a wall between the holes in it would
/// be posts, which hold the sensor along a lane: a simulated one of 91 m got 6 to 17 m too short.
/// There, an object is alone if four columns beside it have no return, or the first one behind it,
/// and what is within 10 m must be in the row above or below, too: the rest may be echoes.
///
/// LeGO-LOAM has none: its edges need five columns on both sides, and its segmentation takes
/// clusters of fewer than 30 pixels for clutter. In open land there is little else: half of the
/// about 70 objects in a scan of 16 rows are one or two columns wide.
std::vector<Post> posts_in_row(const OrganizedCloud& cloud, const Segmentation& segmentation,
                               int row, bool returns_fail);

}  // namespace hqslam::slam
