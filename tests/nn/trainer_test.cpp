#include "hqslam/nn/training/trainer.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "direct/srae.h"
#include "direct/tulip.h"
#include "error_message.h"
#include "small_network.h"
#include "thread_ranks.h"

namespace hqslam::nn {
namespace {

std::vector<RangeImage> scans() {
  std::vector<RangeImage> scans;
  for (int i = 0; i < 3; ++i) {
    scans.push_back(small_scene());
    for (float& range_m : scans.back().range_m) range_m *= 1.0F + 0.2F * static_cast<float>(i);
  }
  return scans;
}

std::unique_ptr<const TrainingScans> in_memory(std::vector<RangeImage> scans) {
  return std::make_unique<ScansInMemory>(std::move(scans));
}

TrainingPlan small_plan() {
  TrainingPlan plan;
  plan.steps = 150;
  plan.batch = 3;
  plan.learning_rate = 3e-3F;
  plan.warm_up_steps = 5;
  plan.augmentation = {.crop_columns = 32, .range_noise_m = 0.02F, .largest_dropout_share = 0.05F};
  return plan;
}

TrainingState fresh_state(const NetworkDescription& description) {
  std::vector<float> parameters = initial_parameters(description, 1);
  const std::size_t count = parameters.size();
  std::vector<float> average = parameters;
  return {std::move(parameters), AdamW({}, count), std::move(average)};
}

UnrolledPlan filtered_du_or() {
  UnrolledPlan description = small_du_or();
  description.filter.min_pixels = 12;
  return description;
}

UnrolledPlan simple_du_with_dropout() {
  UnrolledPlan description = small_simple_du();
  description.plain.dropout = 0.1F;
  return description;
}

void train(Trainer& trainer, int steps) {
  for (int i = 0; i < steps; ++i) trainer.step();
}

TrainingState trained(const NetworkDescription& description, int steps, int threads) {
  Trainer trainer(description, small_plan(), in_memory(scans()), fresh_state(description), threads);
  train(trainer, steps);
  return trainer.state();
}

void check_same(const TrainingState& a, const TrainingState& b) {
  CHECK(a.parameters == b.parameters);
  CHECK(a.average == b.average);
  CHECK(a.optimiser.first_moment == b.optimiser.first_moment);
  CHECK(a.optimiser.second_moment == b.optimiser.second_moment);
  CHECK(a.optimiser.steps == b.optimiser.steps);
}

std::string plan_message(const TrainingPlan& plan) {
  return test::error_message([&] { validate(plan, small_sensor()); });
}

}  // namespace

TEST_CASE("training makes DU-OR better than it was and better than interpolation") {
  const UnrolledPlan description = filtered_du_or();
  Trainer trainer(description, small_plan(), in_memory(scans()), fresh_state(description), 2);
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

TEST_CASE("training makes Simple DU better than it was") {
  const UnrolledPlan description = simple_du_with_dropout();
  Trainer trainer(description, small_plan(), in_memory(scans()), fresh_state(description), 2);
  const Validation before = trainer.validate(scans());
  train(trainer, 60);
  CHECK(trainer.validate(scans()).network.mae_all_m < 0.7 * before.network.mae_all_m);
}

TEST_CASE(
    "training makes SRAE and TULIP better than they were, the same by any number of threads") {
  NetworkDescription srae = small_du_or();
  srae.architecture = std::make_shared<Srae>(SraeShape{.filters = 2, .passes = 1});
  NetworkDescription tulip = srae;
  tulip.architecture = std::make_shared<Tulip>(TulipShape{.channels = 8, .heads = {2, 2}});
  TrainingPlan plan = small_plan();
  plan.augmentation.crop_columns = 0;
  for (const NetworkDescription& description : {srae, tulip}) {
    CAPTURE(name(description));
    Trainer one(description, plan, in_memory(scans()), fresh_state(description), 1);
    Trainer three(description, plan, in_memory(scans()), fresh_state(description), 3);
    double first = 0.0;
    double last = 0.0;
    for (int step = 0; step < 40; ++step) {
      const double loss = one.step().loss;
      three.step();
      if (step < 5) first += loss;
      if (step >= 35) last += loss;
    }
    CHECK(last < 0.7 * first);
    check_same(one.state(), three.state());
  }
}

TEST_CASE("batch norm's statistics follow the scans and no optimiser moves them") {
  NetworkDescription srae = small_du_or();
  srae.architecture = std::make_shared<Srae>(SraeShape{.filters = 1, .passes = 1});
  const TrainingState state = trained(srae, 3, 1);
  std::size_t begin = 0;
  for (const ParameterShape& shape : parameter_shapes(srae)) {
    for (std::int64_t i = 0; i < shape.elements(); ++i) {
      if (!shape.statistic) continue;
      CHECK(state.optimiser.second_moment[begin + i] == 0.0F);
      if (shape.name == "up.0.norm.running_var") CHECK(state.parameters[begin + i] != 1.0F);
    }
    begin += shape.elements();
  }
}

TEST_CASE(
    "the mean that is kept begins with the first step and follows by 10 of 11 in the second") {
  const UnrolledPlan description = small_du_or();
  Trainer trainer(description, small_plan(), in_memory(scans()), fresh_state(description), 1);
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

TEST_CASE("weight decay pulls at the weights of convolutions and linear layers alone") {
  NetworkDescription tulip = small_du_or();
  tulip.architecture = std::make_shared<Tulip>(TulipShape{.channels = 8, .heads = {2, 2}});
  TrainingPlan plan = small_plan();
  plan.augmentation.crop_columns = 0;
  const auto after_a_step = [&](float weight_decay) {
    TrainingState state = fresh_state(tulip);
    state.optimiser.options.weight_decay = weight_decay;
    Trainer trainer(tulip, plan, in_memory(scans()), std::move(state), 1);
    trainer.step();
    return trainer.state().parameters;
  };
  const std::vector<float> usual = after_a_step(0.0F);
  const std::vector<float> decayed = after_a_step(10.0F);
  std::size_t begin = 0;
  int decaying = 0;
  for (const ParameterShape& shape : parameter_shapes(tulip)) {
    const auto count = static_cast<std::size_t>(shape.elements());
    const bool same = std::equal(usual.begin() + static_cast<std::ptrdiff_t>(begin),
                                 usual.begin() + static_cast<std::ptrdiff_t>(begin + count),
                                 decayed.begin() + static_cast<std::ptrdiff_t>(begin));
    CAPTURE(shape.name);
    CHECK(same == !(shape.shape.size() > 1 && shape.name.ends_with("weight")));
    decaying += same ? 0 : 1;
    begin += count;
  }
  CHECK(decaying > 5);
}

TEST_CASE("one, two and three threads train the same bytes") {
  for (const UnrolledPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    const TrainingState one = trained(description, 6, 1);
    check_same(one, trained(description, 6, 2));
    check_same(one, trained(description, 6, 3));
    CHECK(one.parameters != fresh_state(description).parameters);
  }
}

TEST_CASE("one, two and four processes train the same bytes and see the same losses") {
  TrainingPlan plan = small_plan();
  plan.batch = 4;
  for (const UnrolledPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    std::vector<std::pair<TrainingState, double>> ends;
    std::mutex mutex;
    for (const int count : {1, 2, 4}) {
      test::on_ranks(count, [&](Ranks& ranks) {
        Trainer trainer(description, plan, in_memory(scans()), fresh_state(description), 2, ranks);
        double losses = 0.0;
        for (int i = 0; i < 6; ++i) losses += trainer.step().loss;
        const std::lock_guard lock(mutex);
        ends.emplace_back(trainer.state(), losses);
      });
    }
    REQUIRE(ends.size() == 7);
    for (const auto& [state, losses] : ends) {
      check_same(state, ends.front().first);
      CHECK(losses == ends.front().second);
    }
    Trainer usual(description, plan, in_memory(scans()), fresh_state(description), 1);
    train(usual, 6);
    check_same(usual.state(), ends.front().first);
  }
}

TEST_CASE("a batch that processes cannot share is refused with the reason") {
  const UnrolledPlan du_or = small_du_or();
  NetworkDescription srae = small_du_or();
  srae.architecture = std::make_shared<Srae>(SraeShape{.filters = 2, .passes = 1});
  TrainingPlan plan = small_plan();
  plan.augmentation.crop_columns = 0;
  const auto message = [&](const NetworkDescription& description, int batch) {
    plan.batch = batch;
    return test::error_message([&] {
      test::on_ranks(2, [&](Ranks& ranks) {
        Trainer(description, plan, in_memory(scans()), fresh_state(description), 1, ranks);
      });
    });
  };
  CHECK(message(du_or, 4) == "no Error");
  CHECK(test::one_line_with(message(du_or, 3), "batch is 3", "2 processes"));
  CHECK(test::one_line_with(message(srae, 4), "batch norm", "2 processes"));
}

TEST_CASE("a training that stopped and went on gives the same bytes as one that never stopped") {
  for (const UnrolledPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    const TrainingState whole = trained(description, 8, 1);
    const TrainingState half = trained(description, 3, 2);
    Trainer second(description, small_plan(), in_memory(scans()), half, 2);
    train(second, 5);
    check_same(second.state(), whole);
  }
}

TEST_CASE("another seed trains other bytes") {
  const UnrolledPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  plan.seed = 2;
  Trainer trainer(description, plan, in_memory(scans()), fresh_state(description), 1);
  train(trainer, 2);
  CHECK(trainer.state().parameters != trained(description, 2, 1).parameters);
}

TEST_CASE("the gradient and the loss of a batch are means: equal samples give those of one") {
  const UnrolledPlan description = small_du_or();
  RangeImage rings(16, 64);  // the same from every side, so that turning it changes nothing
  for (int i = 0; i < 16 * 64; ++i) rings.range_m[i] = 30.0F - static_cast<float>(i / 64);
  TrainingPlan plan = small_plan();
  plan.augmentation = {.smallest_scale = 1.0F, .largest_scale = 1.0F};
  TrainingStep steps[2];
  for (const int batch : {1, 5}) {
    plan.batch = batch;
    Trainer trainer(description, plan, in_memory({rings}), fresh_state(description), 1);
    steps[batch / 5] = trainer.step();
  }
  CHECK(steps[1].loss == doctest::Approx(steps[0].loss).epsilon(1e-6));
  CHECK(steps[1].gradient_norm == doctest::Approx(steps[0].gradient_norm).epsilon(1e-5));
}

TEST_CASE("every step draws samples of its own") {
  const UnrolledPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  plan.learning_rate = 1e-30F;  // the network stays as it is
  Trainer trainer(description, plan, in_memory(scans()), fresh_state(description), 1);
  std::set<double> losses;
  for (int i = 0; i < 8; ++i) losses.insert(trainer.step().loss);
  const std::vector<float> before = fresh_state(description).parameters;
  for (std::size_t i = 0; i < before.size(); ++i) {
    REQUIRE(std::fabs(trainer.state().parameters[i] - before[i]) < 1e-20);
  }
  CHECK(losses.size() == 8);
}

TEST_CASE("without a share in the loss inner layers only serve the last one") {
  const UnrolledPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  std::vector<TrainingStep> steps;
  for (const float share : {0.0F, 1.0F}) {
    plan.layer_loss_share = share;
    Trainer trainer(description, plan, in_memory(scans()), fresh_state(description), 1);
    steps.push_back(trainer.step());
  }
  CHECK(steps[0].loss == steps[1].loss);  // it is the last layer's
  CHECK(steps[0].gradient_norm < steps[1].gradient_norm);
}

TEST_CASE(
    "a step reports the loss before it, the unclipped norm, and moves no parameter by more "
    "than the learning rate allows") {
  const UnrolledPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  plan.largest_gradient_norm = 1e-9;
  Trainer trainer(description, plan, in_memory(scans()), fresh_state(description), 1);
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

TEST_CASE("validation does not depend on the threads or on dropout, and of nothing is zero") {
  const UnrolledPlan description = simple_du_with_dropout();
  Trainer one(description, small_plan(), in_memory(scans()), fresh_state(description), 1);
  Trainer two(description, small_plan(), in_memory(scans()), fresh_state(description), 2);
  const Validation a = one.validate(scans());
  CHECK(a.network.mae_all_m == two.validate(scans()).network.mae_all_m);
  CHECK(a.network.mae_all_m == one.validate(scans()).network.mae_all_m);
  CHECK(one.validate({}).network.mae_all_m == 0.0);
}

TEST_CASE("plans that cannot be followed are refused with the field and the value") {
  CHECK(plan_message(small_plan()) == "no Error");
  TrainingPlan plan = small_plan();
  plan.steps = 0;
  CHECK(test::one_line_with(plan_message(plan), "steps is 0"));
  plan = small_plan();
  plan.batch = 0;
  CHECK(test::one_line_with(plan_message(plan), "batch is 0"));
  plan = small_plan();
  plan.learning_rate = -1.0F;
  CHECK(test::one_line_with(plan_message(plan), "learning_rate is -1"));
  plan = small_plan();
  plan.learning_rate = std::nanf("");
  CHECK(test::one_line_with(plan_message(plan), "learning_rate"));
  plan = small_plan();
  plan.layer_loss_share = -0.1F;
  CHECK(test::one_line_with(plan_message(plan), "layer_loss_share is -0.1"));
  plan = small_plan();
  plan.augmentation.crop_columns = 65;
  CHECK(test::one_line_with(plan_message(plan), "crop_columns is 65"));
  plan = small_plan();
  plan.augmentation.smallest_scale = 2.0F;
  CHECK(test::one_line_with(plan_message(plan), "smallest_scale is 2"));
  plan = small_plan();
  plan.augmentation.largest_dropout_share = 1.0F;
  CHECK(test::one_line_with(plan_message(plan), "largest_dropout_share is 1"));
}

TEST_CASE("scans and states that do not fit the network are refused, by any number of threads") {
  const UnrolledPlan description = small_du_or();
  const auto message = [&](std::vector<RangeImage> with, const TrainingState& state) {
    return test::error_message(
        [&] { Trainer(description, small_plan(), in_memory(std::move(with)), state, 2); });
  };
  const TrainingState good = fresh_state(description);
  CHECK(message(scans(), good) == "no Error");
  CHECK(test::one_line_with(message({}, good), "no scans"));
  CHECK(test::one_line_with(message({RangeImage(16, 32)}, good), "16 x 32", "16 x 64"));
  TrainingState bad = good;
  bad.parameters.pop_back();
  CHECK(test::one_line_with(message(scans(), bad), std::to_string(bad.parameters.size())));
  bad = good;
  bad.optimiser.second_moment.pop_back();
  CHECK(test::one_line_with(message(scans(), bad), std::to_string(good.parameters.size())));
  Trainer trainer(description, small_plan(), in_memory(scans()), good, 2);
  CHECK(test::one_line_with(test::error_message([&] {
                              trainer.validate({small_scene(), RangeImage(16, 32)});
                            }),
                            "16 x 32"));
}

TEST_CASE("scans in memory are of one shape and numbered from 0") {
  const auto message = [](std::vector<RangeImage> with, std::int64_t scan) {
    return test::error_message([&] { return ScansInMemory(std::move(with)).read(scan); });
  };
  CHECK(ScansInMemory(scans()).read(2).range_m == scans()[2].range_m);
  CHECK(test::one_line_with(message({RangeImage(16, 32), RangeImage(8, 32)}, 0), "8 x 32",
                            "16 x 32"));
  CHECK(test::one_line_with(message(scans(), 3), "scan 3", "0 to 2"));
  CHECK(test::one_line_with(message(scans(), -1), "scan -1", "0 to 2"));
}

TEST_CASE("a training whose loss is not finite stops with an Error, by any number of threads") {
  const UnrolledPlan description = small_du_or();
  for (const int threads : {1, 2}) {
    TrainingState state = fresh_state(description);
    state.parameters[0] = std::nanf("");
    Trainer trainer(description, small_plan(), in_memory(scans()), state, threads);
    CHECK(test::one_line_with(test::error_message([&] { trainer.step(); }), "not finite"));
  }
}

}  // namespace hqslam::nn
