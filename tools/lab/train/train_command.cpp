#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/training/checkpoint.h"
#include "hqslam/nn/training/drawn_beams.h"
#include "hqslam/nn/training/starting_parameters.h"
#include "hqslam/nn/training/training_configuration.h"
#include "hqslam/nn/weights_file.h"
#include "laboratory.h"
#include "recording/recording_choice.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "timing/timing.h"
#include "train/train_on_recording.h"
#include "train/training_scans.h"

namespace hqslam::tools {
namespace {

struct TrainOptions {
  std::string config;
  InputChoice recording;   ///< to train on, in the place of a configuration
  std::string start_from;  ///< weights, with a recording
  std::int64_t steps = 400;
  std::string out;
  std::string drives;  ///< empty: the folder "drives" in `out`
  int threads = 0;     ///< 0: what OpenMP chooses
};

/// The state of a training beside its trainer.
struct Training {
  std::string configuration_path;
  std::string configuration_text;
  nn::TrainingConfiguration configuration;
  std::filesystem::path out;
  std::vector<nn::CurvePoint> curve;
  double loss_sum = 0.0;  ///< over the steps since the last point of the curve
  std::int64_t training_scans = 0;
  std::vector<nn::TrainingScan> validation;

  std::string checkpoint_path() const { return (out / "checkpoint.npz").string(); }
};

/// Throws Error if the results would replace files of something else.
void guard_training(const Training& training) {
  constexpr std::array<const char*, 3> kResults = {"checkpoint.npz", "weights.npz", "curve.json"};
  guard_results(training.out, kResults, std::filesystem::exists(training.checkpoint_path()),
                "there is no checkpoint.npz of a training",
                {training.configuration_path, training.configuration.start_from});
}

/// The checkpoint's state, or else a new one: with the parameters of the weights file to start from
/// or, without one, random ones.
nn::TrainingState starting_state(Training& training) {
  const nn::TrainingConfiguration& c = training.configuration;
  if (std::filesystem::exists(training.checkpoint_path())) {
    nn::Checkpoint checkpoint = nn::read_checkpoint(
        training.checkpoint_path(), training.configuration_text, c.network, c.plan.adamw);
    training.curve = std::move(checkpoint.curve);
    training.loss_sum = checkpoint.loss_sum;
    return std::move(checkpoint.state);
  }
  std::vector<float> parameters = nn::initial_parameters(c.network, c.plan.seed);
  if (!c.start_from.empty()) {
    parameters = nn::parameters_to_start_from(
        nn::read_weights(c.start_from, nn::all_architectures()), c.network, c.start_from);
  }
  const std::size_t count = parameters.size();
  std::vector<float> average = parameters;
  return {std::move(parameters), nn::AdamW(c.plan.adamw, count), std::move(average)};
}

nlohmann::ordered_json figures_json(const nn::ImageFigures& figures) {
  return {{"mae_all_m", figures.mae_all_m},
          {"mae_valid_m", figures.mae_valid_m},
          {"wrong_share", figures.wrong_share},
          {"missing_share", figures.missing_share}};
}

/// The loss and the validation's errors over the steps.
std::string curve_json(const std::vector<nn::CurvePoint>& curve) {
  nlohmann::ordered_json json = {{"written_by", "hqslam-lab train"},
                                 {"points", nlohmann::ordered_json::array()}};
  for (const nn::CurvePoint& point : curve) {
    json["points"].push_back({{"step", point.step},
                              {"loss", point.loss},
                              {"network", figures_json(point.validation.network)},
                              {"linear", figures_json(point.validation.linear)}});
  }
  return json.dump(1) + "\n";
}

/// The part of the weights file that describes the training.
std::string training_json(const Training& training, const nn::TrainingState& state) {
  nlohmann::ordered_json json;
  json["code_version"] = HQSLAM_VERSION;
  json["steps_done"] = state.optimiser.steps;
  json["training_scans"] = training.training_scans;
  json["validation_scans"] = training.validation.size();
  if (!training.curve.empty()) {
    const nn::Validation& v = training.curve.back().validation;
    json["validation"] = {{"network", figures_json(v.network)}, {"linear", figures_json(v.linear)}};
    if (has_confidence(training.configuration.network)) {
      json["validation"]["least_confidence"] = v.least_confidence;
      json["validation"]["confidence_exponent"] = v.confidence_exponent;
    }
  }
  json["configuration"] = nlohmann::ordered_json::parse(training.configuration_text);
  return json.dump();
}

void write_checkpoint(const Training& training, const nn::TrainingState& state) {
  nn::write_checkpoint(training.checkpoint_path(),
                       {training.configuration_text, state, training.curve, training.loss_sum});
}

bool is_of_own_sensor(const nn::TrainingScan& scan, const nn::NetworkDescription& network) {
  return !scan.sensor || (scan.sensor->sensor == network.sensor &&
                          scan.sensor->measured_rows == network.measured_rows);
}

void write_results(const Training& training, const nn::TrainingState& state) {
  nn::NetworkDescription network = training.configuration.network;
  write_checkpoint(training, state);
  if (has_confidence(network)) {
    const nn::Validation& v = training.curve.back().validation;
    network.least_confidence =
        static_cast<float>(std::pow(v.least_confidence, v.confidence_exponent));
    network.confidence_exponent = static_cast<float>(v.confidence_exponent);
  }
  nn::TrainingScan scan = *std::ranges::find_if(
      training.validation,
      [&](const nn::TrainingScan& each) { return is_of_own_sensor(each, network); });
  if (const auto& all = training.configuration.plan.drawn_from; all && !scan.sensor) {
    scan = nn::seen_by(nn::beams_like(*all, network.sensor, network.measured_rows), scan);
  }
  const RangeImage sample = select_rows(scan.truth, network.measured_rows);
  const auto trained =
      nn::make_network(network, network.sensor.columns, nn::chosen_instruction_set(), 1);
  trained->set_parameters(state.average);
  nn::write_weights((training.out / "weights.npz").string(),
                    {network, state.average, training_json(training, state),
                     nn::make_self_test(*trained, sample)});
  write_text_file(curve_json(training.curve), (training.out / "curve.json").string());
}

/// Reads the validation scans and returns the training scans; null if interrupted.
std::unique_ptr<const nn::TrainingScans> load_scans(Training& training, const DriveStore& store,
                                                    const InterruptGuard& interrupt) {
  const nn::TrainingConfiguration& c = training.configuration;
  const auto validation = stored_scans(c.validation, c, store, "validation scans", interrupt);
  if (validation == nullptr) return nullptr;
  for (std::int64_t i = 0; i < validation->size(); ++i) {
    training.validation.push_back(validation->read(i));
  }
  if (std::ranges::none_of(training.validation,
                           [&](const auto& scan) { return is_of_own_sensor(scan, c.network); })) {
    throw Error("validation: expected a drive or stack of the network's own sensor among them");
  }
  auto scans = stored_scans(c.training, c, store, "training scans", interrupt);
  if (scans != nullptr) training.training_scans = scans->size();
  return scans;
}

std::string of_linear(const nn::Validation& v, const nn::NetworkDescription& network) {
  return fmt::format(
      "MAE all {:.3f}, valid {:.3f}, wrong {:.3f} (missing {:.3f} against {:.3f}{})",
      v.network.mae_all_m / v.linear.mae_all_m, v.network.mae_valid_m / v.linear.mae_valid_m,
      v.network.wrong_share / v.linear.wrong_share, v.network.missing_share, v.linear.missing_share,
      has_confidence(network) ? fmt::format(", confidence {:.3f}", v.least_confidence) : "");
}

void print_point(const nn::CurvePoint& point, const nn::TrainingConfiguration& configuration,
                 double steps_per_s) {
  const std::int64_t steps = configuration.plan.steps;
  const double left_min = static_cast<double>(steps - point.step) / steps_per_s / 60.0;
  to_stdout("step {:>7}/{}  loss {:.4f}  of linear's: {}  {:.1f} min left\n", point.step, steps,
            point.loss, of_linear(point.validation, configuration.network), left_min);
}

/// Prints the validation of a network with a memory once more, on the scans without recall.
void print_without_memory(nn::Trainer& trainer, const nn::NetworkDescription& network,
                          std::vector<nn::TrainingScan> scans) {
  const auto recalls = [](const nn::TrainingScan& scan) { return !scan.recalled.is_empty(); };
  if (std::ranges::none_of(scans, recalls)) return;
  for (nn::TrainingScan& scan : scans) scan.recalled = {};
  to_stdout("              without memory: {}\n", of_linear(trainer.validate(scans), network));
}

/// Trains until the last step or until it is interrupted. Returns an ExitStatus.
int train(Training& training, nn::Trainer& trainer, const InterruptGuard& interrupt) {
  const std::int64_t steps = training.configuration.plan.steps;
  const std::int64_t first = trainer.state().optimiser.steps;
  Progress progress("train", steps, stderr, "steps");
  const SteadyClock::time_point start = SteadyClock::now();
  for (std::int64_t step = first; step < steps && !interrupt.stop_requested();) {
    training.loss_sum += trainer.step().loss;
    ++step;
    progress.update(step);
    if (step % training.configuration.validate_every != 0 && step != steps) continue;
    const double elapsed_s = seconds_since(start);
    const std::int64_t steps_since_point =
        step - (training.curve.empty() ? 0 : training.curve.back().step);
    training.curve.push_back({step, training.loss_sum / static_cast<double>(steps_since_point),
                              trainer.validate(training.validation)});
    training.loss_sum = 0.0;
    print_point(training.curve.back(), training.configuration,
                static_cast<double>(step - first) / elapsed_s);
    print_without_memory(trainer, training.configuration.network, training.validation);
    write_results(training, trainer.state());
  }
  if (first >= steps && !training.curve.empty()) {  // the training had ended: write the results
    training.curve.back().validation = trainer.validate(training.validation);
    write_results(training, trainer.state());
  }
  progress.finish();
  write_checkpoint(training,
                   trainer.state());  // between two points of the curve only this is written
  return trainer.state().optimiser.steps < steps ? kInterrupted : kOk;
}

void declare(CLI::App& app, TrainOptions& options) {
  Command command = add_command(
      app, "train", "Train a super-resolution network on simulated drives and your own scans",
      R"(Writes into --out: weights.npz (for --weights and --upsample), checkpoint.npz, and
curve.json: the errors of network and linear interpolation over the steps.
The drives of the recipe are simulated once into --drives (0.26 MB for a scan of 64 x 1024)
and read from there scan by scan.
Ctrl-C stops after the current step; the same command then continues exactly there. The
recipes of the weights that come with hqslam are weights/*.json.)");
  Command what = command.alternatives("Source", "what to train on");
  what.option("--config", &options.config,
              "Recipe (.json): network, drives and settings of the training")
      .option("--from-recording", &options.recording.input,
              "A recording on which weights are trained further: what other scans "
              "measured is the truth between the rows of each; its last fifth is held out",
              {.given = Given::kFileOrFolder});
  command
      .option("--start-from", &options.start_from,
              "Weights that are trained further on the recording",
              {.given = Given::kFile, .needs = {"--from-recording"}})
      .option("--steps", &options.steps, "Number of training steps on the recording",
              {.shows_default = true, .needs = {"--from-recording"}})
      .option("--sensor", &options.recording.sensor, "Sensor of the recording, as for hqslam run",
              {.needs = {"--from-recording"}});
  declare_reading(command, options.recording);
  command
      .option("--out", &options.out,
              "Folder for results; a training whose checkpoint is in it is continued",
              {.required = true})
      .option("--drives", &options.drives,
              "Folder for the simulated drives, which several trainings may share (default: "
              "OUT/drives)",
              {.needs = {"--config"}});
  declare_threads(command, options.threads);
}

int run(const TrainOptions& options) {
  const int all_threads = options.threads > 0 ? options.threads : omp_get_max_threads();
  if (!options.recording.input.empty()) {
    if (options.start_from.empty()) throw Error("train: --from-recording needs --start-from");
    return train_on_recording(
        {options.recording, options.start_from, options.out, options.steps, all_threads});
  }
  const InterruptGuard interrupt;
  Training training;
  training.configuration_path = options.config;
  training.configuration_text =
      whole_file(options.config, "a training configuration (.json)", 1U << 20U);
  training.configuration = nn::training_configuration(training.configuration_text, options.config,
                                                      nn::all_architectures());
  training.out = options.out;
  guard_training(training);
  make_result_folder(training.out);
  const FolderLock lock(training.out);
  nn::TrainingState state = starting_state(training);
  const nn::TrainingConfiguration& c = training.configuration;
  std::optional<nn::Trainer> prepared;
  try {
    const DriveStore store{
        options.drives.empty() ? training.out / "drives" : std::filesystem::path(options.drives),
        all_threads};
    auto scans = load_scans(training, store, interrupt);
    if (scans == nullptr) return kInterrupted;
    prepared.emplace(c.network, c.plan, std::move(scans), std::move(state), all_threads);
  } catch (const Error& error) {
    throw Error("{}: {}", options.config, error.what());
  }
  nn::Trainer& trainer = *prepared;
  to_stdout("{}: {} parameters, {} training scans, {} validation scans, from step {}\n",
            nn::name(c.network), trainer.state().parameters.size(), training.training_scans,
            training.validation.size(), trainer.state().optimiser.steps);
  const int status = train(training, trainer, interrupt);
  if (status == kInterrupted) {
    to_stderr("hqslam-lab: interrupted at step {}; the same command continues from there\n",
              trainer.state().optimiser.steps);
  }
  to_stdout("results: {}\n", options.out);
  return status;
}

}  // namespace

void add_train(CLI::App& app, Chosen& chosen) { add_subcommand<TrainOptions>(app, chosen); }

}  // namespace hqslam::tools
