#include "laboratory/table/table_variants.h"

#include <fmt/format.h>

#include <limits>

#include "laboratory/table/table_plan.h"

namespace hqslam::tools {
namespace {

bool any(const TableMethod&) { return true; }
bool lifts_rows(const TableMethod& method) { return !method.source.empty(); }
bool sees_all_rows(const TableMethod& method) { return method.rows == kTableAllRows; }

void match_computed_rows(SlamSetup& setup) { setup.sensor.measured_rows.reset(); }

/// What a lifting without any error would give, if it is used as the others are.
void match_sixteen_rows(SlamSetup& setup) {
  setup.sensor.measured_rows = selection_for(setup.sensor.rows(), kTableMeasuredRows);
}

void match_whole_map(SlamSetup& setup) {
  setup.options.mapping.recent_path_m = std::numeric_limits<double>::max();
}

void trust_every_residual(SlamSetup& setup) {
  setup.options.mapping.trusted_residual_m = std::numeric_limits<double>::max();
}

void allow_bent_ground(SlamSetup& setup) {
  setup.options.mapping.max_ground_residual_m = setup.options.mapping.max_plane_residual_m;
}

void run_as_published(SlamSetup& setup) { setup.as_published = true; }

}  // namespace

const std::vector<SlamVariant>& slam_variants() {
  static const std::vector<SlamVariant> variants = {
      {"computed-rows", "computed rows matched too", lifts_rows, match_computed_rows},
      {"16-rows", "16 rows of it matched", sees_all_rows, match_sixteen_rows},
      {"whole-map", "the whole map matched", any, match_whole_map},
      {"plain-weights", "no robust weights", any, trust_every_residual},
      {"bent-ground", "LeGO-LOAM's ground planes", any, allow_bent_ground},
      {"as-published", "LeGO-LOAM as published", any, run_as_published},
  };
  return variants;
}

std::vector<std::string> slam_variant_names() {
  std::vector<std::string> names;
  for (const SlamVariant& variant : slam_variants())
    names.push_back(fmt::format("+{}", variant.name));
  return names;
}

SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor, bool loop_closing) {
  SlamSetup setup{sensor, {}};
  setup.options.loop_closing.enabled = loop_closing;
  if (method.variant != nullptr) method.variant->change(setup);
  return setup;
}

}  // namespace hqslam::tools
