#include "hqslam/nn/training/trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <thread>

#include "hqslam/core/error.h"
#include "hqslam/nn/hqs/network.h"
#include "random.h"
#include "validation.h"

namespace hqslam::nn {
namespace {

/// Runs job(worker index, item) for every item, item i on worker i mod workers. What a job throws
/// is thrown once all have ended.
template <typename Job>
void in_parallel(int workers, int items, const Job& job) {
  std::vector<std::thread> threads;
  std::vector<std::exception_ptr> thrown(workers);
  const auto run = [&](int worker) {
    try {
      for (int item = worker; item < items; item += workers) job(worker, item);
    } catch (...) {
      thrown[worker] = std::current_exception();
    }
  };
  for (int worker = 1; worker < workers; ++worker) threads.emplace_back(run, worker);
  run(0);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& exception : thrown) {
    if (exception != nullptr) std::rethrow_exception(exception);
  }
}

void check_shape(int rows, int columns, const SensorModel& sensor) {
  if (rows != sensor.rows() || columns != sensor.columns) {
    throw Error(fmt::format("training: a scan of {} x {}, expected the sensor's {} x {}", rows,
                            columns, sensor.rows(), sensor.columns));
  }
}

void check_scans(const std::vector<RangeImage>& scans, const SensorModel& sensor) {
  for (const RangeImage& scan : scans) check_shape(scan.rows, scan.columns, sensor);
}

void check_state(const TrainingState& state, const NetworkDescription& description) {
  const std::int64_t expected = elements(parameter_shapes(description));
  for (const std::vector<float>* values :
       {&state.parameters, &state.average, &state.optimiser.first_moment,
        &state.optimiser.second_moment}) {
    if (static_cast<std::int64_t>(values->size()) != expected) {
      throw Error(fmt::format(
          "training: a state of {} parameters, {} means, {} and {} moments, expected {}",
          state.parameters.size(), state.average.size(), state.optimiser.first_moment.size(),
          state.optimiser.second_moment.size(), expected));
    }
  }
}

/// Weight decay pulls at the convolutions' weights alone: a penalty or a bias that it pulled at
/// would end where the decay wants it.
std::vector<std::uint8_t> decays_of(const NetworkDescription& description) {
  std::vector<std::uint8_t> decays;
  for (const ParameterShape& shape : parameter_shapes(description)) {
    decays.insert(decays.end(), shape.elements(), shape.shape.size() == 4 ? 1 : 0);
  }
  return decays;
}

}  // namespace

struct Trainer::Implementation {
  NetworkDescription description;
  TrainingPlan plan;
  std::unique_ptr<const TrainingScans> scans;
  TrainingState state;
  std::vector<std::uint8_t> decays;
  std::vector<std::unique_ptr<Network>> workers;
  std::vector<std::vector<float>> gradients;  ///< one per sample of the batch
  std::vector<double> losses;

  void run_sample(Network& network, int place);
  void average();
};

void validate(const TrainingPlan& plan, const SensorModel& sensor) {
  const Augmentation& a = plan.augmentation;
  const auto check = [](bool good, const char* field, double value, const char* expected) {
    if (!good) throw Error(fmt::format("training: {} is {}, expected {}", field, value, expected));
  };
  check(plan.steps >= 1, "steps", static_cast<double>(plan.steps), "at least 1");
  check(plan.batch >= 1 && plan.batch <= 1024, "batch", plan.batch, "1 to 1024");
  check(plan.learning_rate > 0.0F, "learning_rate", plan.learning_rate, "above 0");
  check(plan.warm_up_steps >= 0, "warm_up_steps", static_cast<double>(plan.warm_up_steps),
        "at least 0");
  check(plan.layer_loss_share >= 0.0F, "layer_loss_share", plan.layer_loss_share, "at least 0");
  check(plan.average_steps >= 1, "average_steps", static_cast<double>(plan.average_steps),
        "at least 1");
  check(plan.largest_gradient_norm > 0.0, "largest_gradient_norm", plan.largest_gradient_norm,
        "above 0");
  check(a.crop_columns >= 0 && a.crop_columns <= sensor.columns, "crop_columns", a.crop_columns,
        "0 to the sensor's columns");
  check(a.smallest_scale > 0.0F && a.smallest_scale <= a.largest_scale, "smallest_scale",
        a.smallest_scale, "above 0 and at most largest_scale");
  check(a.range_noise_m >= 0.0F, "range_noise_m", a.range_noise_m, "at least 0");
  check(a.largest_dropout_share >= 0.0F && a.largest_dropout_share < 1.0F, "largest_dropout_share",
        a.largest_dropout_share, "0 to below 1");
}

Trainer::Trainer(const NetworkDescription& description, const TrainingPlan& plan,
                 std::unique_ptr<const TrainingScans> scans, TrainingState state, int threads) {
  nn::validate(plan, description.sensor);
  if (scans == nullptr || scans->size() == 0) throw Error("training: no scans to train on");
  check_shape(scans->rows(), scans->columns(), description.sensor);
  check_state(state, description);
  implementation_ = std::make_unique<Implementation>(Implementation{
      description, plan, std::move(scans), std::move(state), decays_of(description), {}, {}, {}});
  Implementation& self = *implementation_;
  const int columns = plan.augmentation.crop_columns > 0 ? plan.augmentation.crop_columns
                                                         : description.sensor.columns;
  for (int i = 0; i < std::clamp(threads, 1, plan.batch); ++i) {
    self.workers.push_back(make_network(description, columns, chosen_instruction_set(), 1));
  }
  self.gradients.assign(plan.batch, std::vector<float>(self.state.parameters.size()));
  self.losses.resize(plan.batch);
}
Trainer::~Trainer() = default;

const TrainingState& Trainer::state() const { return implementation_->state; }

void Trainer::Implementation::run_sample(Network& network, int place) {
  const auto number = static_cast<std::uint64_t>(state.optimiser.steps * plan.batch + place);
  Random random(plan.seed * 0x9E3779B97F4A7C15ULL + number);
  const RangeImage scan = scans->read(random.below(scans->size()));
  const TrainingSample sample = augmented_sample(
      scan, description.sensor, description.measured_rows, plan.augmentation, random.bits());
  std::fill(gradients[place].begin(), gradients[place].end(), 0.0F);
  losses[place] =
      network.add_gradient(sample.measured, sample.truth, {.layer_share = plan.layer_loss_share},
                           random.bits() >> 20, gradients[place]);
}

/// The mean follows at once in the first steps and ever more slowly later.
void Trainer::Implementation::average() {
  const auto steps = static_cast<double>(state.optimiser.steps);
  const auto follow = static_cast<float>(
      std::max(1.0 / static_cast<double>(plan.average_steps), 10.0 / (9.0 + steps)));
  for (std::size_t i = 0; i < state.parameters.size(); ++i) {
    state.average[i] += std::min(follow, 1.0F) * (state.parameters[i] - state.average[i]);
  }
}

TrainingStep Trainer::step() {
  Implementation& self = *implementation_;
  const int workers = static_cast<int>(self.workers.size());
  in_parallel(workers, workers, [&](int worker, int) {
    self.workers[worker]->set_parameters(self.state.parameters);
  });
  in_parallel(workers, self.plan.batch,
              [&](int worker, int place) { self.run_sample(*self.workers[worker], place); });
  std::vector<float>& sum = self.gradients.front();
  double loss = self.losses.front();
  for (int place = 1; place < self.plan.batch; ++place) {
    loss += self.losses[place];
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += self.gradients[place][i];
  }
  const float share = 1.0F / static_cast<float>(self.plan.batch);
  for (float& g : sum) g *= share;
  TrainingStep result;
  result.loss = loss * share;
  result.gradient_norm = clip_norm(self.plan.largest_gradient_norm, sum);
  result.learning_rate = cosine_learning_rate(self.plan.learning_rate, self.plan.warm_up_steps,
                                              self.plan.steps, self.state.optimiser.steps);
  if (!std::isfinite(result.loss) || !std::isfinite(result.gradient_norm)) {
    throw Error(
        fmt::format("training: the loss of step {} is not finite; a smaller learning_rate "
                    "may help",
                    self.state.optimiser.steps));
  }
  self.state.optimiser.step(sum, result.learning_rate, self.decays, self.state.parameters);
  self.average();
  return result;
}

Validation Trainer::validate(const std::vector<RangeImage>& scans) {
  Implementation& self = *implementation_;
  const NetworkDescription& description = self.description;
  check_scans(scans, description.sensor);
  const int workers = static_cast<int>(self.workers.size());
  std::vector<std::unique_ptr<Network>> whole;
  for (int i = 0; i < workers; ++i) {
    whole.push_back(
        make_network(description, description.sensor.columns, chosen_instruction_set(), 1));
    whole.back()->set_parameters(self.state.average);
  }
  std::vector<ValidatedScan> each(scans.size());
  in_parallel(workers, static_cast<int>(scans.size()), [&](int worker, int item) {
    each[item] = validated_scan(*whole[worker], description, scans[item]);
  });
  return validation_of(each);
}

}  // namespace hqslam::nn
