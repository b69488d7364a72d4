#include "hqslam/nn/training/checkpoint.h"

#include "hqslam/core/npz.h"
#include "small_network.h"
#include "testing.h"

namespace hqslam::nn {
namespace {

Checkpoint some_checkpoint() {
  std::vector<float> parameters = initial_parameters(small_du_or(), 2);
  AdamW optimiser({}, parameters.size());
  optimiser.step(std::vector<float>(parameters.size(), 0.25F), 1e-3F, {}, parameters);
  std::vector<float> average = parameters;
  average.front() += 1.0F;
  return {"{\"a\": 1}",
          {parameters, optimiser, average},
          {{1, 2.5, {{1.0, 1.5, 0.2, 0.1}, {2.0, 3.0, 0.4, 0.2}, 0.07}}},
          12.5};
}

}  // namespace

TEST_CASE("a checkpoint brings back parameters, moments, steps and curve exactly") {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.npz");
  const Checkpoint written = some_checkpoint();
  write_checkpoint(path, written);
  const Checkpoint read = read_checkpoint(path, written.configuration, small_du_or(), {});
  CHECK(read.state.parameters == written.state.parameters);
  CHECK(read.state.average == written.state.average);
  CHECK(read.state.optimiser.steps == 1);
  CHECK(read.state.optimiser.first_moment == written.state.optimiser.first_moment);
  CHECK(read.state.optimiser.second_moment == written.state.optimiser.second_moment);
  REQUIRE(read.curve.size() == 1);
  CHECK(read.curve[0].step == 1);
  CHECK(read.curve[0].loss == 2.5);
  CHECK(read.curve[0].validation.network.mae_valid_m == 1.5);
  CHECK(read.curve[0].validation.linear.missing_share == 0.2);
  CHECK(read.curve[0].validation.least_confidence == 0.07);
  CHECK(read.loss_sum == 12.5);
}

TEST_CASE("a checkpoint of another configuration or network, or a damaged one, is refused") {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.npz");
  write_checkpoint(path, some_checkpoint());
  const auto message = [&](const std::string& configuration,
                           const NetworkDescription& description) {
    return test::error_message([&] { read_checkpoint(path, configuration, description, {}); });
  };
  CHECK(test::one_line_with(message("{}", small_du_or()), "another training configuration"));
  CHECK(test::one_line_with(message("{\"a\": 1}", small_simple_du()), "first_moment", "expected"));
  NpzArrays arrays = read_npz(path);
  for (const std::int64_t steps : {std::int64_t{-4}, std::int64_t{1} << 62}) {
    arrays["steps"] = npz_array(std::vector<std::int64_t>{steps}, {1});
    write_npz(path, arrays);
    CHECK(test::one_line_with(message("{\"a\": 1}", small_du_or()), "steps"));
  }
  arrays["steps"] = npz_array(std::vector<std::int64_t>{1}, {1});
  arrays["loss_sum"] = npz_array(std::vector<double>{std::nan("")}, {1});
  write_npz(path, arrays);
  CHECK(test::one_line_with(message("{\"a\": 1}", small_du_or()), "loss_sum", "finite"));
  arrays["loss_sum"] = npz_array(std::vector<double>{12.5}, {1});
  const std::vector<double> point = double_values(arrays.at("curve"), "curve");
  const auto message_of_point = [&](std::size_t place, double value) {
    std::vector<double> changed = point;
    changed.at(place) = value;
    arrays["curve"] = npz_array(changed, {1, static_cast<std::int64_t>(changed.size())});
    write_npz(path, arrays);
    return message("{\"a\": 1}", small_du_or());
  };
  CHECK(message_of_point(0, point.at(0)) == "no Error");
  for (std::size_t place = 0; place < point.size(); ++place) {
    CAPTURE(place);
    CHECK(test::one_line_with(message_of_point(place, std::nan("")), "curve", "finite"));
    CHECK(test::one_line_with(message_of_point(place, -HUGE_VAL), "curve", "finite"));
  }
  CHECK(test::one_line_with(message_of_point(0, -1.0), "curve", "steps of 0"));
  CHECK(test::one_line_with(message_of_point(0, 1e300), "curve", "steps of 0"));
  arrays.erase("steps");
  write_npz(path, arrays);
  CHECK(test::one_line_with(message("{\"a\": 1}", small_du_or()), "steps", "found none"));
}

}  // namespace hqslam::nn
