#include "laboratory/table/table_variants.h"

#include <doctest/doctest.h>

#include <string>

#include "laboratory/table/table_plan.h"

namespace hqslam::tools {
namespace {

/// 64 rows of which every fourth was measured.
SensorModel lifted_sensor() {
  SensorModel sensor = sensor_preset("os1-64");
  sensor.measured_rows = selection_for(kTableAllRows, kTableMeasuredRows);
  return sensor;
}

SlamSetup setup_of(const std::string& method, const SensorModel& sensor) {
  TableOptions options;
  options.out = "out";
  options.methods = {method};
  return slam_setup(plan_table(options).methods.front(), sensor, true);
}

}  // namespace

TEST_CASE("without a variant SLAM runs as hqslam run does") {
  const SlamSetup plain = setup_of("du-or", lifted_sensor());
  const slam::MappingOptions usual;
  CHECK(plain.options.loop_closing.enabled);
  CHECK(plain.sensor.measured_rows.has_value());
  CHECK(plain.options.mapping.recent_path_m == usual.recent_path_m);
  CHECK(plain.options.mapping.trusted_residual_m == usual.trusted_residual_m);
  CHECK(plain.options.mapping.max_ground_residual_m == usual.max_ground_residual_m);
}

TEST_CASE("every variant takes away the part that it names, and the options stay valid") {
  const SensorModel lifted = lifted_sensor();
  const SensorModel all = sensor_preset("os1-64");
  CHECK_FALSE(setup_of("du-or+computed-rows", lifted).sensor.measured_rows);
  const std::optional<RowSelection> matched = setup_of("rows-64+16-rows", all).sensor.measured_rows;
  REQUIRE(matched);
  CHECK(*matched == selection_for(kTableAllRows, kTableMeasuredRows));
  CHECK(setup_of("rows-16+whole-map", all).options.mapping.recent_path_m > 1e9);
  CHECK(setup_of("rows-16+plain-weights", all).options.mapping.trusted_residual_m > 1e9);
  CHECK(setup_of("rows-64+bent-ground", all).options.mapping.max_ground_residual_m == 0.2);
  for (const SlamVariant& variant : slam_variants()) {
    for (const TableMethod& method : table_methods()) {
      if (!variant.applies(method)) continue;
      CAPTURE(method.name);
      CAPTURE(variant.name);
      slam::validate(setup_of(method.name + "+" + variant.name, all).options);
    }
  }
}

}  // namespace hqslam::tools
