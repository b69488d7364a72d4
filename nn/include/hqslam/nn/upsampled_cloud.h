#pragma once

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampled_image.h"
#include "hqslam/nn/upsampler.h"

namespace hqslam::nn {

/// Joins what was measured with what was computed: the rows of `measured_rows` are those of
/// `measured`, points and times exactly as recorded; the pixels between them come from `upsampled`.
///
/// upsampled: all rows of `sensor`; measured: as many rows as measured_rows says, in the same
/// columns. The points of a real sensor lie off its beam table by fractions of a degree, row by row
/// and column by column. A computed point gets the deviation of the measured points above and below
/// it in its column,
///   elevation = beam_elevation[row] + (1 - t) deviation_above + t deviation_below
/// with t how far down the row lies between the two (0 to 1); of one of them where the other has no
/// return; none where neither has one. Its capture time is the sensor model's for its pixel,
/// shifted as the time of the nearer one of the two is. A motion-corrected scan has no times. The
/// cloud's confidence is the image's. The intensity of a computed point is that of the measured
/// ones above and below it, as far down between the two as it lies, where the ranges of both are
/// within a fifth of its own; else that of the one nearer in range; not a number where neither has
/// a return. Throws Error if a shape differs.
OrganizedCloud upsampled_cloud(const UpsampledImage& upsampled, const OrganizedCloud& measured,
                               RowSelection measured_rows, const SensorModel& sensor);

/// The same of what the upsampler makes of the measured rows, and of what is recalled if it has a
/// memory.
OrganizedCloud upsampled_cloud(Upsampler& upsampler, const OrganizedCloud& measured,
                               const RecalledImage& recalled = {});

}  // namespace hqslam::nn
