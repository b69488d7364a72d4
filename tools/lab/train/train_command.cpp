#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/training/checkpoint.h"
#include "hqslam/nn/training/starting_parameters.h"
#include "hqslam/nn/training/training_configuration.h"
#include "hqslam/nn/weights_file.h"
#include "lab_commands.h"
#include "ranks/ranks.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "timing/timing.h"
#include "train/learning_curve.h"
#include "train/training_scans.h"

namespace hqslam::tools {
namespace {

/// A training on its way: what is written and how it goes on.
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

/// Throws Error if the results would replace what is not this training's.
void guard_training(const Training& training) {
  constexpr std::array<const char*, 3> kResults = {"checkpoint.npz", "weights.npz", "curve.svg"};
  guard_results(training.out, kResults, std::filesystem::exists(training.checkpoint_path()),
                "there is no checkpoint.npz of a training",
                {training.configuration_path, training.configuration.start_from});
}

/// Throws Error, before hours of simulation, if the processes cannot share the batches.
void require_shares(const Training& training, const Ranks& ranks) {
  try {
    nn::require_shares(training.configuration.network, training.configuration.plan, ranks);
  } catch (const Error& error) {
    throw Error("{}: {}", training.configuration_path, error.what());
  }
}

/// Random parameters, those of the weights file to begin with, or the checkpoint's.
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

/// What stands in the weights file about how they were made.
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

void write_results(const Training& training, const nn::TrainingState& state) {
  nn::NetworkDescription network = training.configuration.network;
  write_checkpoint(training, state);
  if (has_confidence(network)) {
    const nn::Validation& v = training.curve.back().validation;
    network.least_confidence =
        static_cast<float>(std::pow(v.least_confidence, v.confidence_exponent));
    network.confidence_exponent = static_cast<float>(v.confidence_exponent);
  }
  const RangeImage sample = select_rows(training.validation.front().truth, network.measured_rows);
  const auto trained =
      nn::make_network(network, network.sensor.columns, nn::chosen_instruction_set(), 1);
  trained->set_parameters(state.average);
  nn::write_weights((training.out / "weights.npz").string(),
                    {network, state.average, training_json(training, state),
                     nn::make_self_test(*trained, sample)});
  write_text_file(learning_curve_svg(training.curve), (training.out / "curve.svg").string());
}

/// Reads the validation scans; returns those to train on, null if asked to stop.
std::unique_ptr<const nn::TrainingScans> load_scans(Training& training, const DriveStore& store,
                                                    const InterruptGuard& interrupt) {
  const nn::TrainingConfiguration& c = training.configuration;
  const auto validation =
      stored_scans(c.validation, c.network, store, "validation scans", interrupt);
  if (validation == nullptr) return nullptr;
  for (std::int64_t i = 0; i < validation->size(); ++i) {
    training.validation.push_back(validation->read(i));
  }
  auto scans = stored_scans(c.training, c.network, store, "training scans", interrupt);
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

/// The same scans with nothing recalled; nothing if they recall nothing.
void print_without_memory(nn::Trainer& trainer, const nn::NetworkDescription& network,
                          std::vector<nn::TrainingScan> scans) {
  const auto recalls = [](const nn::TrainingScan& scan) { return !scan.recalled.is_empty(); };
  if (std::ranges::none_of(scans, recalls)) return;
  for (nn::TrainingScan& scan : scans) scan.recalled = {};
  to_stdout("              without memory: {}\n", of_linear(trainer.validate(scans), network));
}

/// Trains until the last step or until any rank is asked to stop; rank 0 validates and writes.
/// Returns an ExitStatus.
int train(Training& training, nn::Trainer& trainer, const InterruptGuard& interrupt, Ranks& ranks) {
  const std::int64_t steps = training.configuration.plan.steps;
  const std::int64_t first = trainer.state().optimiser.steps;
  Progress progress("train", steps, stderr, "steps");
  const SteadyClock::time_point start = SteadyClock::now();
  for (std::int64_t step = first; step < steps && !ranks.any(interrupt.stop_requested());) {
    training.loss_sum += trainer.step().loss;
    ++step;
    progress.update(step);
    if (step % training.configuration.validate_every != 0 && step != steps) continue;
    if (ranks.rank() > 0) continue;
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
  const int status = trainer.state().optimiser.steps < steps ? kInterrupted : kOk;
  if (ranks.rank() > 0) return status;
  if (first >= steps && !training.curve.empty()) {  // it had ended: only the results anew
    training.curve.back().validation = trainer.validate(training.validation);
    write_results(training, trainer.state());
  }
  progress.finish();
  write_checkpoint(training, trainer.state());  // between two points of the curve nothing else
  return status;
}

}  // namespace

void declare(CLI::App& app, TrainOptions& options) {
  Command command = add_command(
      app, "train", "Train a super-resolution network on simulated or own scans",
      R"(Writes into --out: weights.npz (for --weights and --upsample), checkpoint.npz, curve.svg.
The drives of the recipe are simulated once (0.26 MB for a scan of 64 x 1024) and read
from --drives scan by scan.
Ctrl-C stops after the step; the same command goes on exactly where it stopped. The recipes
of the weights that come with hqslam are beside them, weights/*.json.
mpirun -n N shares each batch among N processes, with the same bytes as a result; N must
divide the batch, and all must see the same folders.)");
  command
      .option("--config", &options.config, "Network, data and recipe (.json)", {.required = true})
      .option("--out", &options.out, "Folder for results; a checkpoint in it is continued from",
              {.required = true})
      .option("--drives", &options.drives,
              "Folder that keeps the simulated drives (default: OUT/drives); trainings may share "
              "one");
  declare_threads(command, options.threads);
}

int run(const TrainOptions& options) {
  const InterruptGuard interrupt;
  const std::unique_ptr<Ranks> ranks = launched_ranks();
  Training training;
  training.configuration_path = options.config;
  std::optional<FolderLock> lock;
  std::optional<nn::TrainingState> state;
  ranks->rank_0_first([&] {
    training.configuration_text =
        whole_file(options.config, "a training configuration (.json)", 1U << 20U);
    training.configuration = nn::training_configuration(training.configuration_text, options.config,
                                                        nn::all_architectures());
    training.out = options.out;
    if (ranks->rank() == 0) {
      guard_training(training);
      require_shares(training, *ranks);
      make_result_folder(training.out);
      lock.emplace(training.out);
    }
    state = starting_state(training);
  });
  const nn::TrainingConfiguration& c = training.configuration;
  const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
  std::optional<nn::Trainer> prepared;
  try {
    const DriveStore store{
        options.drives.empty() ? training.out / "drives" : std::filesystem::path(options.drives),
        threads, *ranks};
    auto scans = load_scans(training, store, interrupt);
    if (scans == nullptr) return kInterrupted;
    prepared.emplace(c.network, c.plan, std::move(scans), std::move(*state), threads, *ranks);
  } catch (const Error& error) {
    throw Error("{}: {}", options.config, error.what());
  }
  nn::Trainer& trainer = *prepared;
  to_stdout("{}: {} parameters, {} training scans, {} validation scans, from step {}\n",
            nn::name(c.network), trainer.state().parameters.size(), training.training_scans,
            training.validation.size(), trainer.state().optimiser.steps);
  const int status = train(training, trainer, interrupt, *ranks);
  if (status == kInterrupted && ranks->rank() == 0) {
    to_stderr("hqslam: interrupted at step {}; the same command goes on from there\n",
              trainer.state().optimiser.steps);
  }
  to_stdout("results: {}\n", options.out);
  return status;
}

}  // namespace hqslam::tools
