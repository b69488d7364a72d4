#include "hqslam/nn/training/checkpoint.h"

#include "hqslam/core/npz.h"
#include "small_training.h"

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
  const TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.npz");
  const Checkpoint written = some_checkpoint();
  write_checkpoint(path, written);
  const Checkpoint read = read_checkpoint(path, written.configuration, small_du_or(), {});
  check_same(read.state, written.state);
  REQUIRE(read.curve.size() == 1);
  CHECK(read.curve[0].step == 1);
  CHECK(read.curve[0].loss == 2.5);
  CHECK(read.curve[0].validation.network.mae_valid_m == 1.5);
  CHECK(read.curve[0].validation.linear.missing_share == 0.2);
  CHECK(read.curve[0].validation.least_confidence == 0.07);
  CHECK(read.loss_sum == 12.5);
}

TEST_CASE("a checkpoint of another configuration or network, or a damaged one, is refused") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.npz");
  write_checkpoint(path, some_checkpoint());
  const auto message = [&](const std::string& configuration, const NetworkDescription& network) {
    return error_message([&] { read_checkpoint(path, configuration, network, {}); });
  };
  CHECK(one_line_with(message("{}", small_du_or()), "another training configuration"));
  CHECK(one_line_with(message("{\"a\": 1}", small_simple_du()), "first_moment", "expected"));
  const NpzArrays good = read_npz(path);
  const auto refuses = [&](const char* name, const std::optional<NpzArray>& instead,
                           const auto&... parts) {
    NpzArrays arrays = good;
    arrays.erase(name);
    if (instead) arrays[name] = *instead;
    write_npz(path, arrays);
    CHECK(one_line_with(message("{\"a\": 1}", small_du_or()), name, parts...));
  };
  for (const std::int64_t steps : {std::int64_t{-4}, std::int64_t{1} << 62}) {
    refuses("steps", npz_array(std::vector{steps}, {1}), "expected");
  }
  refuses("steps", {}, "found none");
  refuses("loss_sum", npz_array(std::vector{std::nan("")}, {1}), "finite");
  const std::vector<double> point = double_values(good.at("curve"), "curve");
  const auto refuses_point = [&](std::size_t place, double value, const char* said) {
    std::vector<double> changed = point;
    changed.at(place) = value;
    refuses("curve", npz_array(changed, {1, std::ssize(changed)}), said);
  };
  for (std::size_t place = 0; place < point.size(); ++place) {
    CAPTURE(place);
    for (const double value : {std::nan(""), -HUGE_VAL}) refuses_point(place, value, "finite");
  }
  for (const double step : {-1.0, 1e300}) refuses_point(0, step, "steps of 0");
}

}  // namespace hqslam::nn
