#include "hqslam/nn/training/trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <thread>

#include "hqslam/core/error.h"
#include "hqslam/core/image_error.h"
#include "hqslam/nn/hqs/interpolation.h"
#include "hqslam/nn/hqs/result.h"
#include "hqslam/nn/hqs/unrolled_network.h"
#include "hqslam/nn/training/l1_loss.h"
#include "random.h"

namespace hqslam::nn {
namespace {

/// One thread's network and memory.
struct Worker {
  Worker(const NetworkDescription& description, int columns)
      : network(description, columns, chosen_instruction_set(), 1),
        state(network.make_state()),
        truth(state.z0),
        d_z(description.layers, state.z0) {}
  UnrolledNetwork network;
  UnrolledState state;
  Tensor truth;
  std::vector<Tensor> d_z;  ///< of each layer
};

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
  std::int64_t expected = 0;
  for (const ParameterShape& shape : parameter_shapes(description)) expected += shape.elements();
  for (const std::vector<float>* values :
       {&state.parameters, &state.optimiser.first_moment, &state.optimiser.second_moment}) {
    if (static_cast<std::int64_t>(values->size()) != expected) {
      throw Error(fmt::format("training: a state of {} parameters, {} and {} moments, expected {}",
                              state.parameters.size(), state.optimiser.first_moment.size(),
                              state.optimiser.second_moment.size(), expected));
    }
  }
}

}  // namespace

struct Trainer::Implementation {
  NetworkDescription description;
  TrainingPlan plan;
  std::unique_ptr<const TrainingScans> scans;
  TrainingState state;
  std::vector<Worker> workers;
  std::vector<std::vector<float>> gradients;  ///< one per sample of the batch
  std::vector<double> losses;

  void run_sample(Worker& worker, int place);
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
  implementation_ = std::make_unique<Implementation>(
      Implementation{description, plan, std::move(scans), std::move(state), {}, {}, {}});
  Implementation& self = *implementation_;
  const int columns = plan.augmentation.crop_columns > 0 ? plan.augmentation.crop_columns
                                                         : description.sensor.columns;
  for (int i = 0; i < std::clamp(threads, 1, plan.batch); ++i) {
    self.workers.emplace_back(description, columns);
  }
  self.gradients.assign(plan.batch, std::vector<float>(self.state.parameters.size()));
  self.losses.resize(plan.batch);
}
Trainer::~Trainer() = default;

const TrainingState& Trainer::state() const { return implementation_->state; }

void Trainer::Implementation::run_sample(Worker& worker, int place) {
  const auto number = static_cast<std::uint64_t>(state.optimiser.steps * plan.batch + place);
  Random random(plan.seed * 0x9E3779B97F4A7C15ULL + number);
  const RangeImage scan = scans->read(random.below(scans->size()));
  TrainingSample sample = augmented_sample(scan, description.sensor, description.measured_rows,
                                           plan.augmentation, random.bits());
  const TileSize tile = tile_of(description);
  for (float& range : sample.truth.range_m) range /= description.range_scale_m;
  to_tiles(sample.truth.range_m.data(), tile, worker.truth);
  worker.network.start(sample.measured, worker.state);
  worker.network.forward(worker.state, random.bits() >> 20);
  for (int layer = 0; layer < description.layers; ++layer) {
    const bool last = layer + 1 == description.layers;
    losses[place] = l1_loss(worker.state.layer(layer).denoiser.z, worker.truth, tile,
                            last ? std::optional(description.measured_rows) : std::nullopt,
                            last ? 1.0F : plan.layer_loss_share, worker.d_z[layer]);
  }
  std::fill(gradients[place].begin(), gradients[place].end(), 0.0F);
  worker.network.backward(worker.state, worker.d_z, gradients[place]);
}

TrainingStep Trainer::step() {
  Implementation& self = *implementation_;
  const int workers = static_cast<int>(self.workers.size());
  in_parallel(workers, workers, [&](int worker, int) {
    self.workers[worker].network.set_parameters(self.state.parameters);
  });
  in_parallel(workers, self.plan.batch,
              [&](int worker, int place) { self.run_sample(self.workers[worker], place); });
  std::vector<float>& sum = self.gradients.front();
  double loss = self.losses.front();
  for (int place = 1; place < self.plan.batch; ++place) {
    loss += self.losses[place];
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += self.gradients[place][i];
  }
  const float share = 1.0F / static_cast<float>(self.plan.batch);
  for (float& g : sum) g *= share;
  TrainingStep result;
  result.loss_m = loss * share * self.description.range_scale_m;
  result.gradient_norm = clip_norm(self.plan.largest_gradient_norm, sum);
  result.learning_rate = cosine_learning_rate(self.plan.learning_rate, self.plan.warm_up_steps,
                                              self.plan.steps, self.state.optimiser.steps);
  if (!std::isfinite(result.loss_m) || !std::isfinite(result.gradient_norm)) {
    throw Error(
        fmt::format("training: the loss of step {} is not finite; a smaller learning_rate "
                    "may help",
                    self.state.optimiser.steps));
  }
  self.state.optimiser.step(sum, result.learning_rate, self.state.parameters);
  return result;
}

Validation Trainer::validate(const std::vector<RangeImage>& scans) {
  Implementation& self = *implementation_;
  const NetworkDescription& description = self.description;
  check_scans(scans, description.sensor);
  const int workers = static_cast<int>(self.workers.size());
  const int items = static_cast<int>(scans.size());
  std::vector<Worker> whole;
  for (int i = 0; i < workers; ++i) {
    whole.emplace_back(description, description.sensor.columns);
    whole.back().network.set_parameters(self.state.parameters);
  }
  std::vector<Validation> each(scans.size());
  in_parallel(workers, items, [&](int index, int item) {
    Worker& worker = whole[index];
    const RangeImage& truth = scans[item];
    const RangeImage measured = select_rows(truth, description.measured_rows);
    worker.network.start(measured, worker.state);
    worker.network.forward(worker.state);
    RangeImage image = restored_image(description, tile_of(description),
                                      worker.network.result(worker.state), measured);
    const ImageError error = image_error(image, truth);
    each[item].mae_all_m = error.mae_all_m;
    each[item].mae_valid_m = error.mae_valid_m;
    OutlierRemoval filter(description.sensor, description.measured_rows, description.last_filter,
                          image.columns);
    std::vector<std::uint8_t> rejected(image.range_m.size());
    filter.find(image.range_m.data(), rejected.data());
    for (std::size_t i = 0; i < rejected.size(); ++i) {
      if (rejected[i] != 0) image.range_m[i] = 0.0F;
    }
    each[item].mae_all_filtered_m = image_error(image, truth).mae_all_m;
    const RangeImage linear =
        interpolate_rows(measured, description.measured_rows, truth.rows, Interpolation::kLinear);
    each[item].mae_all_linear_m = image_error(linear, truth).mae_all_m;
  });
  Validation mean;
  for (const Validation& v : each) {
    mean.mae_all_m += v.mae_all_m / items;
    mean.mae_all_filtered_m += v.mae_all_filtered_m / items;
    mean.mae_all_linear_m += v.mae_all_linear_m / items;
    mean.mae_valid_m += v.mae_valid_m / items;
  }
  return mean;
}

}  // namespace hqslam::nn
