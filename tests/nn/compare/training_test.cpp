#include "small_training.h"
#include "srae.h"

// SRAE's training.
namespace hqslam::nn {
namespace {

NetworkDescription srae_to_train(int filters) {
  return small_network(std::make_shared<Srae>(SraeShape{.filters = filters, .passes = 1}));
}

TrainingPlan plan_of_whole_scans() {
  TrainingPlan plan = small_plan();
  plan.augmentation.crop_columns = 0;
  return plan;
}

}  // namespace

TEST_CASE("training makes SRAE better than it was, the same by any number of threads") {
  const TrainingPlan plan = plan_of_whole_scans();
  Trainer one = small_trainer(srae_to_train(2), 1, plan);
  Trainer three = small_trainer(srae_to_train(2), 3, plan);
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

TEST_CASE("batch norm's statistics follow the scans and no optimiser moves them") {
  const NetworkDescription srae = srae_to_train(1);
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

TEST_CASE("weight decay pulls at the weights of convolutions alone") {
  const NetworkDescription srae = srae_to_train(1);
  const auto after_a_step = [&](float weight_decay) {
    TrainingState state = fresh_state(srae);
    state.optimiser.options.weight_decay = weight_decay;
    Trainer trainer(srae, plan_of_whole_scans(), in_memory(scans()), std::move(state), 1);
    trainer.step();
    return trainer.state().parameters;
  };
  const std::vector<float> usual = after_a_step(0.0F);
  const std::vector<float> decayed = after_a_step(10.0F);
  std::size_t begin = 0;
  int decaying = 0;
  for (const ParameterShape& shape : parameter_shapes(srae)) {
    const auto count = static_cast<std::size_t>(shape.elements());
    const bool same =
        std::equal(usual.begin() + begin, usual.begin() + begin + count, decayed.begin() + begin);
    CAPTURE(shape.name);
    CHECK(same == !(shape.shape.size() > 1 && shape.name.ends_with("weight")));
    decaying += same ? 0 : 1;
    begin += count;
  }
  CHECK(decaying > 5);
}

}  // namespace hqslam::nn
