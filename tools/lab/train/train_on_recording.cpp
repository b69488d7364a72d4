#include "train/train_on_recording.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/training/trainer.h"
#include "hqslam/nn/weights_file.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "train/recorded_drive.h"
#include "train/right_share.h"

namespace hqslam::tools {
namespace {

/// The end of the drive that shows whether the training helped; scans between it and the rest would
/// show what was trained on.
constexpr double kHeldOutShare = 0.2;
constexpr std::int64_t kScansBetween = 40;
constexpr std::int64_t kFewestScans = 100;

class ScansInMemory final : public nn::TrainingScans {
 public:
  explicit ScansInMemory(std::vector<nn::TrainingScan> scans) : scans_(std::move(scans)) {}
  std::int64_t size() const override { return std::ssize(scans_); }
  nn::TrainingScan read(std::int64_t i) const override { return scans_[i]; }

 private:
  std::vector<nn::TrainingScan> scans_;
};

/// PixelShares::right of a network with these parameters.
std::vector<double> right_shares(const nn::NetworkDescription& network,
                                 const std::vector<float>& parameters,
                                 const std::vector<nn::TrainingScan>& scans) {
  const auto own =
      nn::make_network(network, network.sensor.columns, nn::chosen_instruction_set(), 1);
  own->set_parameters(parameters);
  return pixel_shares(scans, network.sensor, network.measured_rows,
                      [&](const RangeImage& measured) {
                        return own->upsample({measured, {}}, 0.5F).image;
                      })
      .right;
}

/// The scans that are trained on and, at the end, those that are held out.
std::pair<std::vector<nn::TrainingScan>, std::vector<nn::TrainingScan>> split(
    const RecordedDrive& drive, const std::string& path) {
  const auto count = std::ssize(drive.scans);
  if (count < kFewestScans) {
    throw Error("{}: expected at least {} scans that SLAM locates, found {}; give a longer drive",
                path, kFewestScans, count);
  }
  const auto first_held =
      static_cast<std::int64_t>((1.0 - kHeldOutShare) * static_cast<double>(count));
  const std::int64_t trained = first_held - std::min(kScansBetween, first_held / 4);
  std::vector<nn::TrainingScan> training(drive.scans.begin(), drive.scans.begin() + trained);
  return {std::move(training), {drive.scans.begin() + first_held, drive.scans.end()}};
}

nn::TrainingPlan plan_of(std::int64_t steps, const SensorModel& sensor) {
  nn::TrainingPlan plan;
  plan.steps = steps;
  plan.learning_rate = 2e-4F;  // a tenth of what weights are trained with from the start
  plan.largest_gradient_norm = 1.0;
  plan.average_steps = std::max<std::int64_t>(steps / 5, 1);
  plan.augmentation.crop_columns = std::min(512, sensor.columns);
  return plan;
}

/// The trained parameters; nothing if interrupted.
std::optional<std::vector<float>> trained(const nn::NetworkDescription& network,
                                          std::vector<nn::TrainingScan> scans,
                                          const RecordingTraining& training,
                                          const std::vector<float>& parameters,
                                          const InterruptGuard& interrupt) {
  const nn::TrainingPlan plan = plan_of(training.steps, network.sensor);
  const nn::AdamW optimiser(plan.adamw, parameters.size());
  nn::Trainer trainer(network, plan, std::make_unique<ScansInMemory>(std::move(scans)),
                      {parameters, optimiser, parameters}, training.threads);
  Progress progress("train", plan.steps, stderr, "steps");
  for (std::int64_t step = 0; step < plan.steps; ++step) {
    if (interrupt.stop_requested()) return std::nullopt;
    trainer.step();
    progress.advance();
  }
  progress.finish();
  return trainer.state().average;
}

}  // namespace

int train_on_recording(const RecordingTraining& training) {
  const InterruptGuard interrupt;
  nn::Weights weights = nn::read_weights(training.start_from);
  if (has_scan_memory(weights.description)) {  // which would learn to expect no recall
    throw Error(
        "{}: expected weights without a memory, which a recording cannot teach, found some with "
        "one; start from those of du-mix",
        training.start_from);
  }
  guard_results(training.out, std::array{"weights.npz"}, false, "would be replaced",
                {training.recording.input, training.start_from});
  make_result_folder(training.out);
  RecordedDrive drive = read_recorded_drive(training.recording, training.start_from, interrupt);
  if (interrupt.stop_requested()) return kInterrupted;
  nn::NetworkDescription network = weights.description;
  if (fits_any_sensor(network)) {
    network = for_sensor(network, drive.sensor, drive.measured_rows);
  }
  auto [scans, held_out] = split(drive, training.recording.input);
  const std::vector<double> before = right_shares(network, weights.parameters, held_out);
  if (before.size() < kFewestScansOfGain) {
    throw Error(
        "{}: expected {} scans at its end of which other scans measured something, found {}",
        training.recording.input, kFewestScansOfGain, before.size());
  }
  const auto parameters =
      trained(network, std::move(scans), training, weights.parameters, interrupt);
  if (!parameters) return kInterrupted;
  const std::vector<double> after = right_shares(network, *parameters, held_out);
  const Gain gain = gain_of(before, after);
  const bool is_better = gain.mean > 2.0 * gain.standard_error;
  if (is_better) {
    nlohmann::ordered_json json = {
        {"recording", training.recording.input},
        {"steps", training.steps},
        {"right_share_before", mean_of(before)},
        {"right_share", mean_of(after)},
        {"started_from", nlohmann::ordered_json::parse(weights.training)}};
    weights.training = json.dump();
    weights.parameters = *parameters;
    const nn::NetworkDescription& own = weights.description;
    const auto made = nn::make_network(own, own.sensor.columns, nn::chosen_instruction_set(), 1);
    made->set_parameters(*parameters);
    weights.self_test = nn::make_self_test(*made, weights.self_test.measured);
  }
  const std::string path = training.out + "/weights.npz";
  nn::write_weights(path, weights);
  to_stdout(
      "{} scans held out: of the pixels between their rows that other scans measured, {:.1f} % are "
      "within {} m, {:.1f} % after {} steps ({:+.1f} +- {:.1f}, standard error)\n{}: {}\n",
      before.size(), 100.0 * mean_of(before), kRightRange_m, 100.0 * mean_of(after), training.steps,
      100.0 * gain.mean, 100.0 * gain.standard_error, path,
      is_better ? "the new weights" : "the old weights, because the new ones are no better");
  return kOk;
}

}  // namespace hqslam::tools
