#pragma once

#include <memory>

#include "hqslam/nn/training/trainable_network.h"

namespace hqslam::nn {

/// What an architecture outside nn/hqs implements so that its networks can be trained.
class TrainableArchitecture {
 public:
  virtual ~TrainableArchitecture() = default;
  virtual std::unique_ptr<TrainableNetwork> make_trainable(
      const NetworkDescription& description, int columns, InstructionSet instruction_set) const = 0;
};

}  // namespace hqslam::nn
