#include <doctest/doctest.h>

#include <string>

#include "error_message.h"
#include "small_training.h"

namespace hqslam::nn {
namespace {

std::string plan_message(const TrainingPlan& plan) {
  return test::error_message([&] { validate(plan, small_sensor()); });
}

}  // namespace

TEST_CASE("a batch that processes cannot share is refused with the reason") {
  CHECK(message_of_two_ranks(small_du_or(), 4) == "no Error");
  CHECK(test::one_line_with(message_of_two_ranks(small_du_or(), 3), "batch is 3", "2 processes"));
}

TEST_CASE("plans that cannot be followed are refused with the field and the value") {
  CHECK(plan_message(small_plan()) == "no Error");
  struct Wrong {
    void (*spoil)(TrainingPlan&);
    const char* said;
  };
  for (const auto& [spoil, said] : {
           Wrong{[](TrainingPlan& p) { p.steps = 0; }, "steps is 0"},
           Wrong{[](TrainingPlan& p) { p.batch = 0; }, "batch is 0"},
           Wrong{[](TrainingPlan& p) { p.learning_rate = -1.0F; }, "learning_rate is -1"},
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
    CHECK(test::one_line_with(plan_message(plan), said));
  }
}

TEST_CASE("scans and states that do not fit the network are refused, by any number of threads") {
  const HqsPlan description = small_du_or();
  const auto message = [&](std::vector<RangeImage> with, const TrainingState& state) {
    return test::error_message(
        [&] { Trainer(description, small_plan(), in_memory(std::move(with)), state, 2, alone()); });
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
  Trainer trainer(description, small_plan(), in_memory(scans()), good, 2, alone());
  CHECK(test::one_line_with(test::error_message([&] {
                              trainer.validate({small_scene(), RangeImage(16, 32)});
                            }),
                            "16 x 32"));
}

TEST_CASE("a training whose loss is not finite stops with an Error, by any number of threads") {
  const HqsPlan description = small_du_or();
  for (const int threads : {1, 2}) {
    TrainingState state = fresh_state(description);
    state.parameters[0] = std::nanf("");
    Trainer trainer(description, small_plan(), in_memory(scans()), state, threads, alone());
    CHECK(test::one_line_with(test::error_message([&] { trainer.step(); }), "not finite"));
  }
}

}  // namespace hqslam::nn
