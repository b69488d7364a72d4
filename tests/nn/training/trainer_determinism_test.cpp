#include <omp.h>

#include "small_training.h"

namespace hqslam::nn {

TEST_CASE("one, two and three threads train the same bytes, another seed others") {
  for (const HqsPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    const TrainingState one = trained(description, 6, 1);
    check_same(one, trained(description, 6, 2));
    check_same(one, trained(description, 6, 3));
    CHECK(one.parameters != fresh_state(description).parameters);
    TrainingPlan plan = small_plan();
    plan.seed = 2;
    Trainer other = small_trainer(description, 1, plan);
    train(other, 6);
    CHECK(other.state().parameters != one.parameters);
  }
}

TEST_CASE("a training inside a parallel region of the caller's trains the same bytes") {
  for (const NetworkDescription& description :
       {NetworkDescription(filtered_du_or()), NetworkDescription(simple_du_with_dropout()),
        small_du_mix()}) {
    const TrainingState alone = trained(description, 3, 1);
    std::vector<TrainingState> of_team(2, alone);
#pragma omp parallel num_threads(2)
    of_team[omp_get_thread_num()] = trained(description, 3, 1 + omp_get_thread_num());
    for (const TrainingState& state : of_team) check_same(state, alone);
  }
}

TEST_CASE("a training that stopped and went on gives the same bytes as one that never stopped") {
  for (const HqsPlan& description : {filtered_du_or(), simple_du_with_dropout()}) {
    Trainer second(description, small_plan(), in_memory(scans()), trained(description, 3, 2), 2);
    train(second, 5);
    check_same(second.state(), trained(description, 8, 1));
  }
}

TEST_CASE("a network for any beams is trained on drawn sensors, the same ones by any threads") {
  const NetworkDescription description = small_any_beams({3, 4});
  const SensorModel many = even_sensor(272, description.sensor.columns, 34.0, 0.25);
  const TrainingScan scan{
      made_image(272, many.columns, [](int row, int column) { return 5 + (row + column) % 7; })};
  TrainingPlan plan = small_plan();
  plan.drawn_from = many;
  plan.augmentation.crop_columns = 32;
  const auto trained_by = [&](int threads) {
    Trainer trainer(description, plan, in_memory({scan}), fresh_state(description), threads);
    train(trainer, 4);
    return trainer.state();
  };
  const TrainingState one = trained_by(1);
  check_same(one, trained_by(3));
  CHECK(one.parameters != fresh_state(description).parameters);
  plan.drawn_from.reset();
  CHECK(refused_with([&] { trained_by(1); }, "272 x"));
}

TEST_CASE("a network for any beams is trained and validated on scans of several sensors") {
  const NetworkDescription description = small_any_beams({3, 4}, true);
  TrainingScan usual{small_scene()};
  TrainingScan wide{flat_image(8, 128, 7.0F), {}, ScanSensor{description.sensor, {1, 2}}};
  wide.sensor->sensor.columns = 128;
  wide.sensor->sensor.beam_elevation_rad.resize(8);
  wide.sensor->sensor.beam_azimuth_offset_rad.resize(8);
  TrainingPlan plan = small_plan();
  plan.augmentation.crop_columns = 0;  // whole circles, of as many columns as each sensor has
  const auto trained_by = [&](int threads) {
    Trainer trainer(description, plan, in_memory({usual, wide}), fresh_state(description), threads);
    train(trainer, 4);
    CHECK(trainer.validate({wide, usual}).network.mae_all_m > 0.0);
    return trainer.state();
  };
  check_same(trained_by(1), trained_by(3));
  wide.sensor->sensor.columns = 64;
  Trainer trainer(description, plan, in_memory({usual, wide}), fresh_state(description), 1);
  CHECK(refused_with([&] { train(trainer, 4); }, "8 x 128", "8 x 64"));
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
  const Validation a = one.validate(scans());
  CHECK(a.network.mae_all_m == small_trainer(description, 2).validate(scans()).network.mae_all_m);
  CHECK(a.network.mae_all_m == one.validate(scans()).network.mae_all_m);
  CHECK(one.validate({}).network.mae_all_m == 0.0);
}

}  // namespace hqslam::nn
