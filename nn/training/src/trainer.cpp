#include "hqslam/nn/training/trainer.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <span>
#include <thread>

#include "hqslam/core/error.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/training/drawn_beams.h"
#include "hqslam/nn/training/trainable_network.h"
#include "parameters.h"
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
    throw Error("training: a scan of {} x {}, expected the sensor's {} x {}", rows, columns,
                sensor.rows(), sensor.columns);
  }
}

/// usual: the sensor of scans that do not name theirs.
void check_scan(const TrainingScan& scan, const SensorModel& usual) {
  const SensorModel& sensor = scan.sensor ? scan.sensor->sensor : usual;
  const RangeImage& recalled = scan.recalled.image;
  check_shape(scan.truth.rows, scan.truth.columns, sensor);
  if (!scan.recalled.is_empty()) check_shape(recalled.rows, recalled.columns, sensor);
}

void check_state(const TrainingState& state, const NetworkDescription& description) {
  const std::int64_t expected = elements(parameter_shapes(description));
  for (const std::vector<float>* values :
       {&state.parameters, &state.average, &state.optimiser.first_moment,
        &state.optimiser.second_moment}) {
    if (static_cast<std::int64_t>(values->size()) != expected) {
      throw Error("training: a state of {} parameters, {} means, {} and {} moments, expected {}",
                  state.parameters.size(), state.average.size(),
                  state.optimiser.first_moment.size(), state.optimiser.second_moment.size(),
                  expected);
    }
  }
}

/// Weight decay applies to the weights of convolutions and linear layers alone: it would drive a
/// penalty or a bias to zero.
std::vector<std::uint8_t> decays_of(const NetworkDescription& description) {
  std::vector<std::uint8_t> decays;
  for (const ParameterShape& shape : parameter_shapes(description)) {
    const bool is_weight = shape.shape.size() > 1 && shape.name.ends_with("weight");
    decays.insert(decays.end(), shape.elements(), is_weight ? 1 : 0);
  }
  return decays;
}

/// Where the statistics begin and end among the parameters.
std::vector<std::pair<std::size_t, std::size_t>> statistics_of(
    const NetworkDescription& description) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  std::size_t begin = 0;
  for (const ParameterShape& shape : parameter_shapes(description)) {
    const std::size_t end = begin + static_cast<std::size_t>(shape.elements());
    if (shape.statistic) ranges.emplace_back(begin, end);
    begin = end;
  }
  return ranges;
}

/// The share by which a mean over about `steps` steps follows at step 1, 2, ...: at once in the
/// first ones and ever more slowly later.
float follow_share(std::int64_t step, std::int64_t steps) {
  const double share =
      std::max(1.0 / static_cast<double>(steps), 10.0 / (9.0 + static_cast<double>(step)));
  return static_cast<float>(std::min(share, 1.0));
}

/// The steps over which batch norm's statistics are averaged; a momentum of 0.99.
constexpr std::int64_t kStatisticsSteps = 100;

}  // namespace

struct Trainer::Implementation {
  NetworkDescription description;
  TrainingPlan plan;
  std::unique_ptr<const TrainingScans> scans;
  TrainingState state;
  std::vector<std::uint8_t> decays;
  std::vector<std::pair<std::size_t, std::size_t>> statistics;
  std::vector<std::unique_ptr<TrainableNetwork>> workers = {};
  int samples_of_call = 1;
  /// One per call.
  std::vector<double> losses = {};
  std::vector<float> gradients = {};

  struct Drawn {
    TrainingSample sample;
    std::uint64_t seed = 0;                   ///< of what is random in the network
    std::optional<NetworkDescription> other;  ///< the network for the sensor that was drawn
  };
  /// The network for the scan's own sensor, or for one that is drawn from its rows, of which the
  /// scan is then what that sensor sees; nothing: the network is the training's.
  std::optional<NetworkDescription> own_network(TrainingScan& scan, std::uint64_t seed) const;
  Drawn draw(int place) const;
  std::span<float> gradient(int call) {
    const std::size_t parameters = state.parameters.size();
    return std::span(gradients).subspan(parameters * static_cast<std::size_t>(call), parameters);
  }
  void run_calls();
  void run_call(int worker, int call);
  int columns() const {
    return plan.augmentation.crop_columns > 0 ? plan.augmentation.crop_columns
                                              : description.sensor.columns;
  }
  void follow_statistics(std::span<float> gradient);
  void average();
};

void validate(const TrainingPlan& plan, const SensorModel& sensor) {
  const Augmentation& a = plan.augmentation;
  const auto check = [](bool good, const char* field, auto value, const char* expected) {
    check_that(good, "training", field, value, expected);
  };
  check(plan.steps >= 1, "steps", plan.steps, "at least 1");
  check(plan.batch >= 1 && plan.batch <= 1024, "batch", plan.batch, "1 to 1024");
  check(plan.learning_rate > 0.0F, "learning_rate", plan.learning_rate, "above 0");
  check(plan.warm_up_steps >= 0, "warm_up_steps", plan.warm_up_steps, "at least 0");
  check(plan.adamw.weight_decay >= 0.0F, "weight_decay", plan.adamw.weight_decay, "at least 0");
  check(plan.layer_loss_share >= 0.0F, "layer_loss_share", plan.layer_loss_share, "at least 0");
  check(plan.average_steps >= 1, "average_steps", plan.average_steps, "at least 1");
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
  if (plan.drawn_from && !fits_any_sensor(description)) {
    throw Error("training: sensors are drawn for a network of one sensor, expected any_beams");
  }
  if (scans == nullptr || scans->size() == 0) throw Error("training: no scans to train on");
  check_scan(scans->read(0), plan.drawn_from.value_or(description.sensor));
  check_state(state, description);
  implementation_ = std::make_unique<Implementation>(
      Implementation{description, plan, std::move(scans), std::move(state), decays_of(description),
                     statistics_of(description)});
  Implementation& self = *implementation_;
  // With statistics of a batch (batch norm) the gradients of its scans depend on each other.
  if (!self.statistics.empty()) self.samples_of_call = plan.batch;
  const int calls = plan.batch / self.samples_of_call;
  for (int worker = 0; worker < std::clamp(threads, 1, calls); ++worker) {
    self.workers.push_back(make_trainable(description, self.columns(), chosen_instruction_set()));
  }
  self.gradients.resize(calls * self.state.parameters.size());
  self.losses.resize(calls);
}
Trainer::~Trainer() = default;

const TrainingState& Trainer::state() const { return implementation_->state; }

std::optional<NetworkDescription> Trainer::Implementation::own_network(TrainingScan& scan,
                                                                       std::uint64_t seed) const {
  if (scan.sensor) return for_sensor(description, scan.sensor->sensor, scan.sensor->measured_rows);
  if (!plan.drawn_from) return std::nullopt;
  const DrawnBeams beams = draw_beams(*plan.drawn_from, seed);
  scan = seen_by(beams, scan);
  return for_sensor(description, beams.sensor, beams.measured_rows);
}

Trainer::Implementation::Drawn Trainer::Implementation::draw(int place) const {
  const auto number = static_cast<std::uint64_t>(state.optimiser.steps * plan.batch + place);
  Random random(plan.seed * 0x9E3779B97F4A7C15ULL + number);
  TrainingScan scan = scans->read(random.below(scans->size()));
  check_scan(scan, plan.drawn_from.value_or(description.sensor));
  std::optional<NetworkDescription> own = own_network(scan, plan.drawn_from ? random.bits() : 0);
  const NetworkDescription& network = own ? *own : description;
  TrainingSample sample = augmented_sample(scan, network.sensor, network.measured_rows,
                                           plan.augmentation, random.bits());
  return {std::move(sample), random.bits() >> 20, std::move(own)};
}

/// One call of the network: of one sample, or of all together.
void Trainer::Implementation::run_call(int worker, int call) {
  std::vector<TrainingSample> samples;
  std::vector<std::uint64_t> seeds;
  std::unique_ptr<TrainableNetwork> network;
  for (int place = call * samples_of_call; place < (call + 1) * samples_of_call; ++place) {
    Drawn drawn = draw(place);
    if (drawn.other) {  // made for this sensor, and for this call alone
      network = make_trainable(*drawn.other, drawn.sample.truth.columns, chosen_instruction_set());
      network->set_parameters(state.parameters);
    }
    samples.push_back(std::move(drawn.sample));
    seeds.push_back(drawn.seed);
  }
  std::ranges::fill(gradient(call), 0.0F);
  TrainableNetwork& used = network != nullptr ? *network : *workers[worker];
  losses[call] =
      used.add_gradients(samples, {.layer_share = plan.layer_loss_share}, seeds, gradient(call));
}

/// Gradients and losses of the batch.
void Trainer::Implementation::run_calls() {
  const int calls = static_cast<int>(losses.size());
  in_parallel(static_cast<int>(workers.size()), calls, [&](int worker, int call) {
    const bool is_first = call == worker;
    if (is_first) workers[worker]->set_parameters(state.parameters);
    run_call(worker, call);
  });
}

/// Statistics move by a share of their gradient, which the optimiser then does not get.
void Trainer::Implementation::follow_statistics(std::span<float> gradient) {
  const float share = follow_share(state.optimiser.steps + 1, kStatisticsSteps);
  for (const auto& [begin, end] : statistics) {
    for (std::size_t i = begin; i < end; ++i) {
      state.parameters[i] -= share * gradient[i];
      gradient[i] = 0.0F;
    }
  }
}

void Trainer::Implementation::average() {
  const float follow = follow_share(state.optimiser.steps, plan.average_steps);
  for (std::size_t i = 0; i < state.parameters.size(); ++i) {
    state.average[i] += follow * (state.parameters[i] - state.average[i]);
  }
}

TrainingStep Trainer::step() {
  Implementation& self = *implementation_;
  self.run_calls();
  // In the order of the batch, whichever thread computed which part of it.
  const std::span<float> sum = self.gradient(0);
  double loss = self.losses.front();
  for (int call = 1; call < static_cast<int>(self.losses.size()); ++call) {
    loss += self.losses[call];
    const std::span<const float> gradient = self.gradient(call);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += gradient[i];
  }
  const float share = 1.0F / static_cast<float>(self.plan.batch);
  for (float& g : sum) g *= share;
  self.follow_statistics(sum);
  TrainingStep result;
  result.loss = loss * share;
  result.gradient_norm = clip_norm(self.plan.largest_gradient_norm, sum);
  result.learning_rate = cosine_learning_rate(self.plan.learning_rate, self.plan.warm_up_steps,
                                              self.plan.steps, self.state.optimiser.steps);
  if (!std::isfinite(result.loss) || !std::isfinite(result.gradient_norm)) {
    throw Error("training: the loss of step {} is not finite; a smaller learning_rate may help",
                self.state.optimiser.steps);
  }
  self.state.optimiser.step(sum, result.learning_rate, self.decays, self.state.parameters);
  self.average();
  return result;
}

Validation Trainer::validate(const std::vector<TrainingScan>& scans) {
  Implementation& self = *implementation_;
  const NetworkDescription& description = self.description;
  for (const TrainingScan& scan : scans) {
    check_scan(scan, self.plan.drawn_from.value_or(description.sensor));
  }
  const int workers = static_cast<int>(self.workers.size());
  const auto network_of = [&](const NetworkDescription& own) {
    auto network = make_network(own, own.sensor.columns, chosen_instruction_set(), 1);
    network->set_parameters(self.state.average);
    return network;
  };
  std::vector<std::unique_ptr<Network>> whole(workers);
  std::vector<ValidatedScan> each(scans.size());
  in_parallel(workers, static_cast<int>(scans.size()), [&](int worker, int item) {
    if (self.plan.drawn_from || scans[item].sensor) {
      TrainingScan scan = scans[item];
      // The same sensor for the same scan at every validation.
      const auto own = *self.own_network(scan, static_cast<std::uint64_t>(item));
      each[item] = validated_scan(*network_of(own), own, scan);
      return;
    }
    if (whole[worker] == nullptr) whole[worker] = network_of(description);
    each[item] = validated_scan(*whole[worker], description, scans[item]);
  });
  return validation_of(each);
}

}  // namespace hqslam::nn
