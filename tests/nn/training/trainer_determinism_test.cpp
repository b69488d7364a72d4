#include <doctest/doctest.h>
#include <omp.h>

#include <cmath>
#include <set>

#include "small_training.h"

namespace hqslam::nn {

TEST_CASE("one, two and three threads train the same bytes") {
  for (const HqsPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    const TrainingState one = trained(description, 6, 1);
    check_same(one, trained(description, 6, 2));
    check_same(one, trained(description, 6, 3));
    CHECK(one.parameters != fresh_state(description).parameters);
  }
}

TEST_CASE("a training inside a parallel region of the caller's trains the same bytes") {
  const HqsPlan description = simple_du_with_dropout();
  const TrainingState alone = trained(description, 3, 1);
  std::vector<TrainingState> of_team(2, alone);
#pragma omp parallel num_threads(2)
  of_team[omp_get_thread_num()] = trained(description, 3, 1 + omp_get_thread_num());
  for (const TrainingState& state : of_team) check_same(state, alone);
}

TEST_CASE("a training that stopped and went on gives the same bytes as one that never stopped") {
  for (const HqsPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    const TrainingState whole = trained(description, 8, 1);
    const TrainingState half = trained(description, 3, 2);
    Trainer second(description, small_plan(), in_memory(scans()), half, 2);
    train(second, 5);
    check_same(second.state(), whole);
  }
}

TEST_CASE("another seed trains other bytes") {
  const HqsPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  plan.seed = 2;
  Trainer trainer = small_trainer(description, 1, plan);
  train(trainer, 2);
  CHECK(trainer.state().parameters != trained(description, 2, 1).parameters);
}

TEST_CASE("every step draws samples of its own") {
  const HqsPlan description = small_du_or();
  TrainingPlan plan = small_plan();
  plan.learning_rate = 1e-30F;  // the network stays as it is
  Trainer trainer = small_trainer(description, 1, plan);
  std::set<double> losses;
  for (int i = 0; i < 8; ++i) losses.insert(trainer.step().loss);
  const std::vector<float> before = fresh_state(description).parameters;
  for (std::size_t i = 0; i < before.size(); ++i) {
    REQUIRE(std::fabs(trainer.state().parameters[i] - before[i]) < 1e-20);
  }
  CHECK(losses.size() == 8);
}

TEST_CASE("validation does not depend on the threads or on dropout, and of nothing is zero") {
  const HqsPlan description = simple_du_with_dropout();
  Trainer one = small_trainer(description);
  Trainer two = small_trainer(description, 2);
  const Validation a = one.validate(scans());
  CHECK(a.network.mae_all_m == two.validate(scans()).network.mae_all_m);
  CHECK(a.network.mae_all_m == one.validate(scans()).network.mae_all_m);
  CHECK(one.validate({}).network.mae_all_m == 0.0);
}

}  // namespace hqslam::nn
