#pragma once

#include "hqslam/nn/training/trainer.h"
#include "small_network.h"

// Trainings of a moment, on three small scans.
namespace hqslam::nn {

inline std::vector<TrainingScan> scans() {
  std::vector<TrainingScan> scans;
  for (int i = 0; i < 3; ++i) {
    scans.push_back({small_scene()});
    for (float& range_m : scans.back().truth.range_m)
      range_m *= 1.0F + 0.2F * static_cast<float>(i);
  }
  return scans;
}

/// All of one shape.
class ScansInMemory final : public TrainingScans {
 public:
  explicit ScansInMemory(std::vector<TrainingScan> scans) : scans_(std::move(scans)) {}
  std::int64_t size() const override { return std::ssize(scans_); }
  TrainingScan read(std::int64_t i) const override { return scans_.at(i); }

 private:
  std::vector<TrainingScan> scans_;
};

inline std::unique_ptr<const TrainingScans> in_memory(std::vector<TrainingScan> scans) {
  return std::make_unique<ScansInMemory>(std::move(scans));
}

inline TrainingPlan small_plan() {
  TrainingPlan plan;
  plan.steps = 150;
  plan.batch = 3;
  plan.learning_rate = 3e-3F;
  plan.warm_up_steps = 5;
  plan.augmentation = {.crop_columns = 32, .range_noise_m = 0.02F, .largest_dropout_share = 0.05F};
  return plan;
}

inline TrainingState fresh_state(const NetworkDescription& description) {
  std::vector<float> parameters = initial_parameters(description, 1);
  const std::size_t count = parameters.size();
  std::vector<float> average = parameters;
  return {std::move(parameters), AdamW({}, count), std::move(average)};
}

inline HqsPlan filtered_du_or() {
  HqsPlan description = small_du_or();
  description.filter.min_pixels = 12;
  return description;
}

inline HqsPlan simple_du_with_dropout() {
  HqsPlan description = small_simple_du();
  description.plain.dropout = 0.1F;
  return description;
}

inline Trainer small_trainer(const NetworkDescription& description, int threads = 1,
                             const TrainingPlan& plan = small_plan()) {
  return {description, plan, in_memory(scans()), fresh_state(description), threads};
}

inline void train(Trainer& trainer, int steps) {
  for (int i = 0; i < steps; ++i) trainer.step();
}

inline TrainingState trained(const NetworkDescription& description, int steps, int threads) {
  Trainer trainer = small_trainer(description, threads);
  train(trainer, steps);
  return trainer.state();
}

inline void check_same(const TrainingState& a, const TrainingState& b) {
  CHECK(a.parameters == b.parameters);
  CHECK(a.average == b.average);
  CHECK(a.optimiser.first_moment == b.optimiser.first_moment);
  CHECK(a.optimiser.second_moment == b.optimiser.second_moment);
  CHECK(a.optimiser.steps == b.optimiser.steps);
}

}  // namespace hqslam::nn
