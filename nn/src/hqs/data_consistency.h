#pragma once

namespace hqslam::nn {

/// The step that keeps the image true to what was measured: eq. 10a, solved pixel by pixel. With
/// A = (Z + Y) / 2, the mean of the two auxiliaries, and b >= 0 the penalty:
///   measured pixels:  H = (L + 2 b A) / (1 + 2 b);   b -> 0: what was measured stays
///   other pixels:     H = A
/// Differs from the paper, whose eq. 7 and 10a have D^T Y where D^T L is meant; D^T D is 0 or 1 on
/// each pixel, so no matrix is inverted.
///
/// One row of pixels, in any one unit. l: measured ranges; null: none of them is measured.
void data_consistency_row(const float* l, const float* z, const float* y, float penalty,
                          int columns, float* h);

/// d_h: d loss / d H. Writes d loss / d A to d_a and returns the row's part of d loss / d b.
double data_consistency_gradient_row(const float* l, const float* z, const float* y,
                                     const float* d_h, float penalty, int columns, float* d_a);

}  // namespace hqslam::nn
