#include <doctest/doctest.h>

#include "hqslam/nn/network.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/trace.h"

// A program compiled with -mavx2, which the library is not: Eigen's own alignment differs.
namespace hqslam::nn {

TEST_CASE("a trace may be copied, changed and freed by a program compiled for wider vectors") {
  static_assert(EIGEN_MAX_ALIGN_BYTES > 16);
  const NetworkDescription description = network_from_json(
      R"({"kind": "du-or", "sensor": "os1-64", "measured_rows": 16, "layers": 1})", "test");
  const auto network = make_network(description, 64, InstructionSet::kPortable, 1);
  network->set_parameters(initial_parameters(description, 1));
  Trace trace = network->trace(RangeImage(16, 64));
  const Trace copied = trace;
  for (const TracedTensor& tensor : copied.tensors()) {
    TracedTensor longer = tensor;
    longer.values.resize(tensor.channels() + 1, tensor.rows(), tensor.columns());
    longer.values.setZero();
    trace.add(std::move(longer));
  }
  CHECK(trace.tensors().size() == 2 * copied.tensors().size());
}

}  // namespace hqslam::nn
