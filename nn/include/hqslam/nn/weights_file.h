#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

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

/// Makes the self-test of weights from a scan's measured rows.
SelfTest make_self_test(const NetworkDescription& description, const std::vector<float>& parameters,
                        const RangeImage& measured);

/// Reads an .npz file: the arrays by name, "description" (JSON as UTF-8 bytes),
/// "self_test.measured", "self_test.expected". Throws Error with file, field, expected, found for
/// anything unknown, missing or inconsistent.
Weights read_weights(const std::string& path);

/// The parameters of `weights` for a training of `network` to begin with: of the same arrays, or of
/// the same network without a memory: weights that have to do with what is recalled begin with 0.
/// Throws Error with `path` for any other.
std::vector<float> parameters_to_start_from(const Weights& weights,
                                            const NetworkDescription& network,
                                            const std::string& path);
/// Throws Error, also if the parameters are not as many as the description's arrays hold.
void write_weights(const std::string& path, const Weights& weights);

/// What another program saved: the arrays of parameter_shapes(description) by name, of 4 or 8 byte
/// floats, as numpy.savez writes a PyTorch state dict, and if it likes the self-test.
struct ForeignArrays {
  std::vector<float> parameters;
  std::optional<SelfTest> self_test;
};
/// Throws Error with file, array, expected, found for anything unknown, missing or of another
/// shape.
ForeignArrays read_foreign_arrays(const std::string& path, const NetworkDescription& description);

/// Throws Error if the network does not reproduce its self-test to 1e-3 of the range scale.
void check_self_test(const Weights& weights, const std::string& path);

}  // namespace hqslam::nn
