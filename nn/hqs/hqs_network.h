#pragma once

#include <vector>

#include "hqs_loop.h"
#include "hqslam/nn/network.h"

namespace hqslam::nn {

/// The loop of eq. 10 as what upsamples scans. The result is the last Z, or, of a prior with a
/// confidence, what the prior makes of it.
class HqsNetwork final : public Network {
 public:
  HqsNetwork(const NetworkDescription& description, int columns, InstructionSet instruction_set,
             int threads);

  std::int64_t multiply_adds() const override;
  void set_parameters(std::span<const float> parameters) override {
    hqs_.set_parameters(parameters);
  }
  const UpsampledImage& upsample(const Observation& seen, float tolerance_m) override;
  RangeImage estimate(const RangeImage& measured) override;
  Trace trace(const Observation& seen) override;

 private:
  const Tensor& last_z() const { return state_.layer(hqs_.layers - 1).prior.z; }

  NetworkDescription description_;
  Hqs hqs_;
  int threads_;
  HqsState state_;
  UpsampledImage upsampled_;
};

/// The last layer's Z as an image in metres: ranges outside the sensor's limits become "no return",
/// the measured rows are put back. z: tiles. measured: one row per measured row. Called by all
/// threads of a parallel region, which share the work.
void restore_rows(const NetworkDescription& description, TileSize tile, const Tensor& z,
                  const RangeImage& measured, RangeImage& image);

}  // namespace hqslam::nn
