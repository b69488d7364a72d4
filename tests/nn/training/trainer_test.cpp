#include "hqslam/nn/training/trainer.h"

#include "small_training.h"

namespace hqslam::nn {
namespace {

std::string plan_message(const TrainingPlan& plan) {
  return error_message([&] { validate(plan, small_sensor()); });
}

}  // namespace

TEST_CASE("training makes DU-OR better than it was and better than interpolation") {
  Trainer trainer = small_trainer(filtered_du_or(), 2);
  const Validation before = trainer.validate(scans());
  TrainingStep step;
  double first_loss = 0.0;
  double last_loss = 0.0;
  for (int i = 0; i < 150; ++i) {
    step = trainer.step();
    if (i < 10) first_loss += step.loss / 10;
    if (i >= 140) last_loss += step.loss / 10;
  }
  const Validation after = trainer.validate(scans());
  CHECK(last_loss < 0.7 * first_loss);
  CHECK(after.network.mae_all_m < 0.7 * before.network.mae_all_m);
  CHECK(after.network.mae_all_m < after.linear.mae_all_m);
  CHECK(after.linear.mae_all_m == before.linear.mae_all_m);
  CHECK(step.learning_rate < 1e-5F);
  CHECK(trainer.state().optimiser.steps == 150);
}

TEST_CASE("the mean begins with the first step and follows by 10 of 11 in the second") {
  Trainer trainer = small_trainer(small_du_or());
  trainer.step();
  const std::vector<float> first = trainer.state().parameters;
  for (std::size_t i = 0; i < first.size(); ++i) {
    REQUIRE(trainer.state().average[i] == doctest::Approx(first[i]).epsilon(1e-6));
  }
  trainer.step();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double second = trainer.state().parameters[i];
    REQUIRE(trainer.state().average[i] ==
            doctest::Approx(first[i] + 10.0 / 11.0 * (second - first[i])).epsilon(1e-5));
  }
}

TEST_CASE("the gradient and the loss of a batch are means: equal samples give those of one") {
  const HqsPlan description = small_du_or();
  // The same from every side, so that turning it changes nothing.
  const RangeImage rings = made_image(16, 64, [](int row, int) { return 30.0 - row; });
  TrainingPlan plan = small_plan();
  plan.augmentation = {.smallest_scale = 1.0F, .largest_scale = 1.0F};
  TrainingStep steps[2];
  for (const int batch : {1, 5}) {
    plan.batch = batch;
    Trainer trainer(description, plan, in_memory({{rings}}), fresh_state(description), 1);
    steps[batch / 5] = trainer.step();
  }
  CHECK(steps[1].loss == doctest::Approx(steps[0].loss).epsilon(1e-6));
  CHECK(steps[1].gradient_norm == doctest::Approx(steps[0].gradient_norm).epsilon(1e-5));
}

TEST_CASE("without a share in the loss inner layers only serve the last one") {
  const HqsPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  std::vector<TrainingStep> steps;
  for (const float share : {0.0F, 1.0F}) {
    plan.layer_loss_share = share;
    steps.push_back(small_trainer(description, 1, plan).step());
  }
  CHECK(steps[0].loss == steps[1].loss);  // it is the last layer's
  CHECK(steps[0].gradient_norm < steps[1].gradient_norm);
}

TEST_CASE("a step reports the loss before it and the unclipped norm, and moves within its rate") {
  const HqsPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  plan.largest_gradient_norm = 1e-9;
  Trainer trainer = small_trainer(description, 1, plan);
  const TrainingStep step = trainer.step();
  CHECK(step.loss > 0.0);
  CHECK(step.gradient_norm > 1e-3);
  CHECK(step.learning_rate == doctest::Approx(3e-3 / 5));
  const std::vector<float> before = fresh_state(description).parameters;
  for (std::size_t i = 0; i < before.size(); ++i) {
    REQUIRE(std::fabs(trainer.state().parameters[i] - before[i]) <
            1.1 * step.learning_rate * (1.0 + 0.01 * std::fabs(before[i])));
  }
}

TEST_CASE("plans that cannot be followed are refused with the field and the value") {
  CHECK(plan_message(small_plan()) == "no Error");
  using Wrong = std::pair<void (*)(TrainingPlan&), const char*>;
  for (const auto& [spoil, said] : {
           Wrong{[](TrainingPlan& p) { p.steps = 0; }, "steps is 0"},
           Wrong{[](TrainingPlan& p) { p.batch = 0; }, "batch is 0"},
           Wrong{[](TrainingPlan& p) { p.learning_rate = -1.0F; }, "learning_rate is -1"},
           Wrong{[](TrainingPlan& p) { p.adamw.weight_decay = -1.0F; }, "weight_decay is -1"},
           Wrong{[](TrainingPlan& p) { p.learning_rate = std::nanf(""); }, "learning_rate"},
           Wrong{[](TrainingPlan& p) { p.layer_loss_share = -0.1F; }, "layer_loss_share is -0.1"},
           Wrong{[](TrainingPlan& p) { p.augmentation.crop_columns = 65; }, "crop_columns is 65"},
           Wrong{[](TrainingPlan& p) { p.augmentation.smallest_scale = 2.0F; },
                 "smallest_scale is 2"},
           Wrong{[](TrainingPlan& p) { p.augmentation.largest_dropout_share = 1.0F; },
                 "largest_dropout_share is 1"},
       }) {
    TrainingPlan plan = small_plan();
    spoil(plan);
    CHECK(one_line_with(plan_message(plan), said));
  }
}

TEST_CASE("scans and states that do not fit the network are refused, by any number of threads") {
  const HqsPlan description = small_du_or();
  const auto message = [&](std::vector<TrainingScan> with, const TrainingState& state) {
    return error_message(
        [&] { Trainer(description, small_plan(), in_memory(std::move(with)), state, 2); });
  };
  const TrainingState good = fresh_state(description);
  CHECK(message(scans(), good) == "no Error");
  CHECK(one_line_with(message({}, good), "no scans"));
  CHECK(one_line_with(message({{RangeImage(16, 32)}}, good), "16 x 32", "16 x 64"));
  TrainingState bad = good;
  bad.parameters.pop_back();
  CHECK(one_line_with(message(scans(), bad), std::to_string(bad.parameters.size())));
  bad = good;
  bad.optimiser.second_moment.pop_back();
  CHECK(one_line_with(message(scans(), bad), std::to_string(good.parameters.size())));
  Trainer trainer(description, small_plan(), in_memory(scans()), good, 2);
  const std::vector<TrainingScan> mixed = {{small_scene()}, {RangeImage(16, 32)}};
  CHECK(refused_with([&] { trainer.validate(mixed); }, "16 x 32"));
}

TEST_CASE("a training whose loss is not finite stops with an Error, by any number of threads") {
  const HqsPlan description = small_du_or();
  for (const int threads : {1, 2}) {
    TrainingState state = fresh_state(description);
    state.parameters[0] = std::nanf("");
    Trainer trainer(description, small_plan(), in_memory(scans()), state, threads);
    CHECK(refused_with([&] { trainer.step(); }, "not finite"));
  }
}

}  // namespace hqslam::nn
