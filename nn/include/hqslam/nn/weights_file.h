#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/architectures.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

class Network;

/// A sample that comes with the weights: what the network made of it where it was trained.
struct SelfTest {
  RangeImage measured;  ///< the measured rows, metres
  RangeImage expected;  ///< Network::estimate of them
};

/// Everything a weights file holds. `parameters` are the arrays of parameter_shapes(description),
/// one after the other.
struct Weights {
  NetworkDescription description;
  std::vector<float> parameters;
  std::string training;  ///< JSON: data, recipe, seed, metrics, code version; for people
  SelfTest self_test;
};

/// Reads an .npz file: the arrays by name, "description" (JSON as UTF-8 bytes),
/// "self_test.measured", "self_test.expected". Throws Error with file, field, expected, found for
/// anything unknown, missing or inconsistent.
Weights read_weights(const std::string& path,
                     const Architectures& architectures = hqs_architectures());

/// Throws Error, also if there are not as many parameters as the description's arrays hold.
void write_weights(const std::string& path, const Weights& weights);

/// What another program saved: the arrays of parameter_shapes(description) by name, of 4 or 8 byte
/// floats, as numpy.savez writes a PyTorch state dict, and possibly the self-test.
struct ForeignArrays {
  std::vector<float> parameters;
  std::optional<SelfTest> self_test;
};
/// Throws Error with file, array, expected, found for anything unknown, missing or of another
/// shape.
ForeignArrays read_foreign_arrays(const std::string& path, const NetworkDescription& description);

/// Makes the self-test of weights from a scan's measured rows. network: with those weights.
SelfTest make_self_test(Network& network, const RangeImage& measured);

/// Throws Error with `path` if the network, which has the weights of a file, does not reproduce
/// their self-test in 99.9 % of the pixels to `tolerance` of the range scale. Instruction sets
/// differ by less than the default; other programs, which may round to 10 bits, need 1e-3.
void check_self_test(Network& network, const NetworkDescription& description,
                     const SelfTest& self_test, const std::string& path, float tolerance = 1e-5F);

}  // namespace hqslam::nn
