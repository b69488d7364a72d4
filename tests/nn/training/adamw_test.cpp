#include "hqslam/nn/training/adamw.h"

#include "golden.h"

namespace hqslam::nn {

TEST_CASE("AdamW takes the steps that PyTorch's takes") {
  const Golden golden("adamw");
  std::vector<float> parameters = golden.values("start");
  const std::vector<float> rates = golden.values("rates");
  const std::vector<float> gradients = golden.values("gradients");
  const std::vector<float> expected = golden.values("parameters");
  const std::size_t count = parameters.size();
  AdamW optimiser({}, count);
  for (std::size_t step = 0; step < rates.size(); ++step) {
    optimiser.step(std::span(gradients).subspan(step * count, count), rates[step], {}, parameters);
    const std::vector<float> after(expected.begin() + step * count,
                                   expected.begin() + (step + 1) * count);
    CHECK(relative_error(parameters, after) < 1e-5);
  }
  CHECK(optimiser.steps == 6);
}

TEST_CASE("weight decay leaves parameters that do not decay") {
  AdamW optimiser({.weight_decay = 0.5F}, 2);
  std::vector<float> parameters{2.0F, 2.0F};
  optimiser.step(std::vector<float>{0.0F, 0.0F}, 0.5F, std::vector<std::uint8_t>{1, 0}, parameters);
  CHECK(parameters[0] == 1.5F);
  CHECK(parameters[1] == 2.0F);
}

TEST_CASE("clip_norm shortens long gradients only and returns the norm before") {
  std::vector<float> gradient{3.0F, -4.0F};
  CHECK(clip_norm(10.0, gradient) == 5.0);
  CHECK(gradient == std::vector<float>{3.0F, -4.0F});
  CHECK(clip_norm(1.0, gradient) == 5.0);
  CHECK(gradient[0] == doctest::Approx(0.6));
  CHECK(gradient[1] == doctest::Approx(-0.8));
  std::vector<float> hardly_too_long{3.0F, -4.0F};
  CHECK(clip_norm(4.9, hardly_too_long) == 5.0);
  CHECK(hardly_too_long[0] == doctest::Approx(3.0 * 0.98));
  std::vector<float> zero(3);
  CHECK(clip_norm(1.0, zero) == 0.0);
}

TEST_CASE("the learning rate rises linearly and falls on a cosine to zero") {
  const auto rate = [](std::int64_t step) { return cosine_learning_rate(2.0F, 4, 24, step); };
  for (const auto& [step, expected] : std::map<int, double>{
           {0, 0.5}, {1, 1.0}, {3, 2.0}, {4, 2.0}, {14, 1.0}, {24, 0.0}, {100, 0.0}}) {
    CHECK(rate(step) == doctest::Approx(expected));
  }
  for (std::int64_t step = 4; step < 24; ++step) CHECK(rate(step) > rate(step + 1));
  CHECK(cosine_learning_rate(2.0F, 0, 10, 0) == doctest::Approx(2.0));
}

}  // namespace hqslam::nn
