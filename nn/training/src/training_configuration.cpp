#include "hqslam/nn/training/training_configuration.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string_view>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/nn/network_json.h"

namespace hqslam::nn {
namespace {

/// "seeds": a list, or {"first": 1000, "count": 200}.
std::vector<int> seeds_of(JsonFields& fields) {
  constexpr std::int64_t kMostSeeds = 100'000;
  constexpr std::int64_t kLargestSeed = 1'000'000'000;
  if (!fields.is_object("seeds")) return fields.integers("seeds");
  JsonFields span = fields.object("seeds");
  const std::int64_t first = span.integer("first");
  const std::int64_t count = span.integer("count");
  span.finish();
  if (first < 0 || first > kLargestSeed) {
    span.complain("first", fmt::format("0 to {}", kLargestSeed));
  }
  if (count < 1 || count > kMostSeeds) span.complain("count", fmt::format("1 to {}", kMostSeeds));
  std::vector<int> seeds(static_cast<std::size_t>(count));
  std::iota(seeds.begin(), seeds.end(), static_cast<int>(first));
  return seeds;
}

SimulatedScans simulated_scans(JsonFields fields) {
  SimulatedScans scans;
  scans.drive = fields.text("drive");
  scans.seeds = seeds_of(fields);
  scans.scans = fields.integer("scans");
  fields.optional("every", scans.every);
  if (fields.has("conditions")) {
    scans.conditions = fields.choice("conditions", {"usual", "varied"}) == 0
                           ? DriveConditions::kUsual
                           : DriveConditions::kVaried;
  }
  if (fields.has("sensor_errors")) scans.sensor_errors = fields.text("sensor_errors");
  fields.optional("look_ahead", scans.look_ahead);
  scans.own_sensors = fields.has("sensor") && fields.choice("sensor", {"drawn"}) == 0;
  fields.finish();
  if (scans.seeds.empty()) fields.complain("seeds", "at least one seed");
  for (const int seed : scans.seeds) {
    if (seed < 0) fields.complain("seeds", "numbers of at least 0");
  }
  if (scans.scans < 1) fields.complain("scans", "at least 1");
  if (scans.every < 1) fields.complain("every", "at least 1");
  return scans;
}

/// The sensor of a stack, with all rows, and how many of them are measured: "sensor" and
/// "measured_rows".
std::optional<ScanSensor> stack_sensor(JsonFields& entry, const NetworkDescription& network,
                                       const std::string& source) {
  if (!entry.has("sensor")) return std::nullopt;
  if (!fits_any_sensor(network)) entry.complain("sensor", "a network for any_beams, or nothing");
  ScanSensor of_stack{read_sensor_field("sensor", source, entry), {}};
  const auto measured = static_cast<int>(entry.integer("measured_rows"));
  of_stack.measured_rows = selection_for(of_stack.sensor.rows(), measured);
  return of_stack;
}

/// can_draw: there are rows that sensors can be drawn from.
ScanSet scan_set(JsonFields& fields, const std::string& field, const NetworkDescription& network,
                 bool can_draw, const std::string& source) {
  ScanSet set;
  for (JsonFields& entry : fields.objects(field)) {
    if (entry.has("stack")) {
      std::int64_t repeat = 1;
      entry.optional("repeat", repeat);
      if (repeat < 1 || repeat > 10'000) entry.complain("repeat", "1 to 10000");
      set.stacks.insert(set.stacks.end(), static_cast<std::size_t>(repeat),
                        {entry.text("stack"), stack_sensor(entry, network, source)});
      entry.finish();
    } else {
      set.simulated.push_back(simulated_scans(entry));
      if (set.simulated.back().look_ahead && !has_scan_memory(network)) {
        entry.complain("look_ahead", "a network with scan_memory, or nothing");
      }
      if (set.simulated.back().own_sensors && !can_draw) {
        entry.complain("sensor", "a training with drawn_from, or nothing");
      }
    }
  }
  if (set.stacks.empty() && set.simulated.empty()) {
    fields.complain(field, "a list of drives or stacks");
  }
  return set;
}

std::filesystem::path path_of(const StackedScans& stack) {
  return std::filesystem::path(stack.path).lexically_normal();
}

/// Drives of one family and seed have one city: town and town-busy.
std::string_view family_of(std::string_view drive) { return drive.substr(0, drive.find('-')); }

/// Scans that are trained on are no measure for those that are not.
void check_apart(const ScanSet& training, const ScanSet& validation, const std::string& source) {
  for (const StackedScans& stack : validation.stacks) {
    if (std::ranges::count(training.stacks, path_of(stack), path_of) > 0) {
      throw Error(
          "{}: expected different scans for training and validation, found '{}' in both; remove "
          "one",
          source, stack.path);
    }
  }
  for (const SimulatedScans& v : validation.simulated) {
    for (const SimulatedScans& t : training.simulated) {
      for (const int seed : v.seeds) {
        const bool shared = std::ranges::find(t.seeds, seed) != t.seeds.end();
        if (family_of(t.drive) == family_of(v.drive) && shared) {
          throw Error(
              "{}: expected different cities for training and validation, found that of drive {} "
              "with seed {} in both; remove one",
              source, v.drive, seed);
        }
      }
    }
  }
}

void read_augmentation(JsonFields fields, Augmentation& a) {
  fields.optional("crop_columns", a.crop_columns);
  fields.optional("mirror", a.mirror);
  fields.optional("smallest_scale", a.smallest_scale);
  fields.optional("largest_scale", a.largest_scale);
  fields.optional("range_noise_m", a.range_noise_m);
  fields.optional("largest_dropout_share", a.largest_dropout_share);
  fields.finish();
}

}  // namespace

TrainingConfiguration training_configuration(const std::string& text, const std::string& source,
                                             const Architectures& architectures) {
  JsonFields fields(text, source);
  TrainingConfiguration c;
  c.network = network_from_json(fields.dumped("network"), source + ": network", architectures);
  const bool can_draw = fields.has("drawn_from");
  c.training = scan_set(fields, "training", c.network, can_draw, source);
  c.validation = scan_set(fields, "validation", c.network, can_draw, source);
  check_apart(c.training, c.validation, source);
  fields.optional("steps", c.plan.steps);
  fields.optional("batch", c.plan.batch);
  fields.optional("learning_rate", c.plan.learning_rate);
  fields.optional("warm_up_steps", c.plan.warm_up_steps);
  fields.optional("weight_decay", c.plan.adamw.weight_decay);
  fields.optional("largest_gradient_norm", c.plan.largest_gradient_norm);
  fields.optional("layer_loss_share", c.plan.layer_loss_share);
  fields.optional("average_steps", c.plan.average_steps);
  fields.optional("seed", c.plan.seed);
  fields.optional("validate_every", c.validate_every);
  if (can_draw) {
    c.drawn_from = read_sensor_field("drawn_from", source, fields);
    if (!has_scan_memory(c.network)) c.plan.drawn_from = c.drawn_from;
  }
  if (fields.has("start_from")) c.start_from = fields.text("start_from");
  if (fields.has("augmentation")) {
    read_augmentation(fields.object("augmentation"), c.plan.augmentation);
  }
  fields.finish();
  if (c.validate_every < 1) fields.complain("validate_every", "at least 1");
  try {
    validate(c.plan, c.network.sensor);
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
  return c;
}

}  // namespace hqslam::nn
