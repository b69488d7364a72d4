#pragma once

#include <span>

#include "scan.h"

// DU-Mix: one layer of eq. 10 in the limit b -> 0, where what was measured stays, on logarithms of
// ranges (metres), with a prior that gives two modes and the probability of a return. An addition
// to the paper, which has one range per pixel. du_mix.cpp is the layer, du_mix_prior.cpp its prior,
// du_mix_beams.cpp what of the prior depends on the sensor's beams, du_mix_modes.cpp the two modes
// of a pixel.
namespace hqslam::nn::reference {

inline constexpr double kTypicalRange_m = 20.0;

struct Measured {
  Image valid;   ///< measured rows x columns: 1 where there is a return
  Image filled;  ///< metres; no return takes the range above it, at the top a typical one
};

/// What is recalled of each pixel; 0 where nothing is.
struct Recalled {
  Image m;      ///< ln of metres
  Image share;  ///< W^2 / (W^2 + 1)
};

/// The images from which the prior's input is made.
struct MixImages {
  Measured measured;
  Recalled recalled;
  Image start;  ///< ln of metres
  Image h;      ///< ln of metres
};

/// The prior: seven outputs of each computed pixel of a tile, nine with a memory; 84 x 16 x 256 for
/// 4 x 4 tiles and 64 x 1024 pixels. Channel: (output, row, column of the tile).
Image du_mix_prior(Run& run, const MixImages& images);

/// The bias of channel c in measured row y: psi(y) . B[.][c], B of 7 x c,
///   psi = ln gap above, ln gap below, e', e'^2, first, last, ln(column step / 0.35)
double beam_bias(const Run& run, const Array& b, int c, int y);
/// The head for any beams: out[(o, j, x)][y] = (phi W)[(o, x)] . in[.][y] + (phi b)[(o, x)] for
/// output o, computed row j and column x of a tile. W: 22 x (7 x 4) x channels, b: 22 x (7 x 4).
Image head_of_rows(const Run& run, const Image& in, const Array& weight, const Array& bias);

/// The values of which the modes of a pixel are made, in ln of metres.
struct ModesInput {
  double above = 0.0;  ///< of the measured row above
  double below = 0.0;  ///< of the measured row below
  double start = 0.0;
  double h = 0.0;
  double recalled = 0.0;        ///< M
  double recalled_share = 0.0;  ///< W^2 / (W^2 + 1); 0: nothing is recalled
};

/// The prior's result for one pixel. With outputs o, s(v) = 1 / (1 + e^-v) and y in ln of metres:
///   y1 = s(4 o0) above + (1 - s(4 o0)) h + o1      the mode on the side of the row above
///   y2 = s(4 o2) below + (1 - s(4 o2)) h + o3      the mode on the side of the row below
///   w  = s(4 o4)                                   probability of the first
///   scale = exp(-3.5 + 4 clamp(o5, -1/2, 1))       of both Laplace distributions
///   p  = s(4 o6)                                   probability of a return
/// With a memory each mode has an h of its own, start + g (M - start): W^2 scaled by an output,
///   g = W^2 e / (W^2 e + 1),  e = exp(4 clamp(o, -2, 2)),  o = o7 for the first, o8 for the second
struct Modes {
  double mode_1 = 0.0;
  double mode_2 = 0.0;
  double weight_1 = 0.0;
  double scale = 0.0;
  double probability = 0.0;

  /// 10b: the likelier mode.
  double chosen() const { return weight_1 >= 0.5 ? mode_1 : mode_2; }
  /// That there is a return, and within the tolerance of the chosen range.
  double confidence(double tolerance_m, double exponent) const;
};
/// outputs: o0 to o6, with a memory to o8.
Modes modes_of(const ModesInput& in, std::span<const double> outputs);

}  // namespace hqslam::nn::reference
