#pragma once

namespace hqslam::nn {

/// Makes "srae" and "tulip" kinds of networks that recipes and weights files may have, beside those
/// of hqslam::nn. A program that wants them calls it once, before it reads any.
void add_compared_networks();

}  // namespace hqslam::nn
