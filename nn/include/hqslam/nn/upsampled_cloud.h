#pragma once

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampled_image.h"
#include "hqslam/nn/upsampler.h"

namespace hqslam::nn {

/// Joins what was measured with what was computed: the rows of `measured_rows` are those of
/// `measured`, points and times exactly as recorded; the pixels between them come from `upsampled`.
///
/// upsampled: all rows of `sensor`; measured: the rows of measured_rows, in the same columns. The
/// points of a real sensor deviate from its beam table by fractions of a degree, row by row and
/// column by column. A computed point gets the deviation of the measured points above and below
/// it in its column,
///   elevation = beam_elevation[row] + (1 - t) deviation_above + t deviation_below
/// with t the row's place between the two (0 above, 1 below); the deviation of one of them where
/// the other has no return; none where neither has one. Its capture time is the sensor model's for
/// its pixel, shifted as the time of the nearer of the two is. A motion-corrected scan has no
/// times. The cloud's confidence is the image's. The intensity of a computed point is interpolated
/// between the measured ones above and below it where the ranges of both are within a fifth of its
/// own; else it is that of the one nearer in range; not a number where neither has a return. Shapes
/// are those that Upsampler::run checked.
OrganizedCloud upsampled_cloud(const UpsampledImage& upsampled, const OrganizedCloud& measured,
                               RowSelection measured_rows, const SensorModel& sensor);

/// The cloud of what the upsampler makes of the measured rows, and of what is recalled if it has a
/// memory. Throws Error as Upsampler::run.
OrganizedCloud upsampled_cloud(Upsampler& upsampler, const OrganizedCloud& measured,
                               const RecalledImage& recalled = {});

}  // namespace hqslam::nn
