#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "bench/bench_network.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

double frames_per_second(const NetworkRun& run) {
  return run.frame_ms.median > 0.0 ? 1e3 / run.frame_ms.median : 0.0;
}

double gflops(const NetworkStepTiming& step) {
  return step.ms > 0.0 ? 2e3 * step.gmac / step.ms : 0.0;
}

void print_runs(const NetworkTiming& network) {
  to_stdout("{:>12}{:>9}{:>8}{:>12}{:>11}{:>9}{:>10}{:>12}\n", "instructions", "threads", "frames",
            "frames/s", "ms/frame", "95 %", "GFLOP/s", "of peak");
  for (const NetworkRun& run : network.runs) {
    to_stdout("{:>12}{:>9}{:>8}{:>12.1f}{:>11.2f}{:>9.2f}{:>10.1f}{:>10.1f} %\n",
              nn::name(run.instruction_set), run.threads, run.frames, frames_per_second(run),
              run.frame_ms.median, run.frame_ms.p95, run.gflops, 100.0 * run.peak_share);
  }
}

/// Median time of a frame in the run with the steps' instruction set and these threads.
double whole_ms(const NetworkTiming& network, int threads) {
  for (const NetworkRun& run : network.runs) {
    if (run.instruction_set == network.steps_instruction_set && run.threads == threads) {
      return run.frame_ms.median;
    }
  }
  return 0.0;
}

void print_steps(const NetworkTiming& network) {
  to_stdout("\n  steps of the network, each measured alone, {}, median ms per frame\n",
            nn::name(network.steps_instruction_set));
  to_stdout("  {:<18}{:>8}", "", "GMAC");
  for (const NetworkSteps& steps : network.steps) {
    to_stdout("{:>22}",
              fmt::format("{} thread{}: GFLOP/s", steps.threads, steps.threads == 1 ? "" : "s"));
  }
  to_stdout("\n");
  for (std::size_t i = 0; !network.steps.empty() && i < network.steps.front().steps.size(); ++i) {
    const NetworkStepTiming& first = network.steps.front().steps[i];
    to_stdout("  {:<18}{:>8}", first.name,
              first.gmac > 0.0 ? fmt::format("{:.3f}", first.gmac) : "-");
    for (const NetworkSteps& steps : network.steps) {
      const NetworkStepTiming& step = steps.steps[i];
      to_stdout("{:>22}", fmt::format("{:.3f} {:>8}", step.ms,
                                      step.gmac > 0.0 ? fmt::format("{:.0f}", gflops(step)) : "-"));
    }
    to_stdout("\n");
  }
  to_stdout("  {:<18}{:>8}", "whole frame", "");
  for (const NetworkSteps& steps : network.steps) {
    to_stdout("{:>22}", fmt::format("{:.3f} {:>8}", whole_ms(network, steps.threads), ""));
  }
  to_stdout("\n");
  if (!network.reference) return;
  to_stdout(
      "  {} as its reference formula: {:.1f} ms, as used: {:.3f} ms ({:.0f} times as fast, one "
      "thread)\n",
      network.reference->layer, network.reference->reference_ms, network.reference->fast_ms,
      network.reference->reference_ms / network.reference->fast_ms);
}

}  // namespace

void to_json(Json& json, const Distribution& distribution) {
  json = {{"median", distribution.median},
          {"p95", distribution.p95},
          {"max", distribution.max},
          {"mean", distribution.mean}};
}

void to_json(Json& json, const MultiplyAddPeak& peak) {
  json = {{"instruction_set", nn::name(peak.instruction_set)},
          {"threads", peak.threads},
          {"gflops", peak.gflops}};
}

static void to_json(Json& json, const NetworkRun& run) {
  json = {{"instruction_set", nn::name(run.instruction_set)},
          {"threads", run.threads},
          {"frames", run.frames},
          {"frames_per_second", frames_per_second(run)},
          {"frame_ms", run.frame_ms},
          {"gflops", run.gflops},
          {"peak_share", run.peak_share}};
}

static void to_json(Json& json, const NetworkStepTiming& step) {
  json = {{"name", step.name}, {"gmac", step.gmac}, {"ms", step.ms}};
}

static void to_json(Json& json, const NetworkSteps& steps) {
  json = {{"threads", steps.threads}, {"steps", steps.steps}};
}

void to_json(Json& json, const NetworkTiming& network) {
  json = {{"network", network.name},
          {"weights", network.path},
          {"parameters", network.parameters},
          {"gmac", network.gmac},
          {"runs", network.runs},
          {"steps_instruction_set", nn::name(network.steps_instruction_set)},
          {"steps", network.steps}};
  if (network.reference) {
    json["reference"] = {{"layer", network.reference->layer},
                         {"fast_ms", network.reference->fast_ms},
                         {"reference_ms", network.reference->reference_ms}};
  }
}

void print_networks(const std::vector<MultiplyAddPeak>& peaks,
                    const std::vector<NetworkTiming>& networks) {
  if (networks.empty()) return;
  to_stdout("\nMeasured peak of multiply-adds in registers, GFLOP/s\n");
  for (const MultiplyAddPeak& peak : peaks) {
    to_stdout("{:>12}{:>9}{:>10.1f}\n", nn::name(peak.instruction_set), peak.threads, peak.gflops);
  }
  for (const NetworkTiming& network : networks) {
    to_stdout("\n{}: whole network, filter included; {} parameters, {:.3f} GMAC a frame\n",
              network.name, network.parameters, network.gmac);
    print_runs(network);
    print_steps(network);
  }
}

void print_instruction_sets(bool json) {
  const std::string_view chosen = nn::name(nn::chosen_instruction_set());
  std::vector<std::string_view> available;
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    available.push_back(nn::name(set));
  }
  if (json) {
    to_stdout("{}\n", Json{{"instruction_set", chosen}, {"available", available}}.dump(2));
    return;
  }
  to_stdout("in use:    {}\navailable: {}\n", chosen, fmt::join(available, ", "));
}

}  // namespace hqslam::tools
