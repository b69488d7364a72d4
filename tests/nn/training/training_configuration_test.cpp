#include "hqslam/nn/training/training_configuration.h"

#include "hqs/hqs_architecture.h"
#include "testing.h"

namespace hqslam::nn {
namespace {

const std::string kText = R"({
  "network": {"kind": "du-or", "sensor": "os1-64", "measured_rows": 16, "layers": 4,
              "denoiser": {"channels": [8, 16], "memory": 2}},
  "training": [{"drive": "town", "seeds": [1, 2], "scans": 30, "every": 10}, {"stack": "a.npy"}],
  "validation": [{"drive": "town", "seeds": [3], "scans": 10}],
  "steps": 12, "batch": 2, "learning_rate": 0.01,
  "augmentation": {"crop_columns": 256, "mirror": false}
})";

/// Of the text with `to` in place of `from`.
void refuses_recipe(const std::string& from, const std::string& to, const auto&... parts) {
  CAPTURE(to);
  const std::string text = replaced_in(kText, from, to);
  CHECK(refused_with([&] { training_configuration(text, "recipe.json"); }, parts...));
}

}  // namespace

TEST_CASE("a configuration is read field by field, the rest keeps its default") {
  const TrainingConfiguration c = training_configuration(kText, "recipe.json");
  CHECK(hqs_of(c.network).sizes().layers == 4);
  CHECK(hqs_of(c.network).prior().sizes["channels"] == std::vector<int>{8, 16});
  CHECK(c.network.sensor.name == "os1-64");
  CHECK(c.network.measured_rows == RowSelection{3, 4});
  REQUIRE(c.training.simulated.size() == 1);
  CHECK(c.training.simulated[0].seeds == std::vector<int>{1, 2});
  CHECK(c.training.simulated[0].every == 10);
  REQUIRE(c.training.stacks.size() == 1);
  CHECK(c.training.stacks[0].path == "a.npy");
  CHECK_FALSE(c.training.stacks[0].sensor.has_value());
  CHECK(c.plan.steps == 12);
  CHECK(c.plan.learning_rate == doctest::Approx(0.01));
  CHECK(c.plan.augmentation.crop_columns == 256);
  CHECK_FALSE(c.plan.augmentation.mirror);
  CHECK(c.plan.adamw.weight_decay == doctest::Approx(0.01));
  CHECK(c.plan.seed == 1);
}

TEST_CASE("seeds are a list or a span, conditions usual or varied") {
  const TrainingConfiguration c = training_configuration(
      replaced_in(kText, "[1, 2]", R"({"first": 1000, "count": 3}, "conditions": "varied")"),
      "recipe.json");
  CHECK(c.training.simulated[0].seeds == std::vector<int>{1000, 1001, 1002});
  CHECK(c.training.simulated[0].conditions == DriveConditions::kVaried);
  CHECK(c.validation.simulated[0].conditions == DriveConditions::kUsual);
}

TEST_CASE("drives and stacks of a network for any beams have sensors of their own") {
  std::string text = kText;
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"du-or", "du-mix"},
           {R"("layers": 4,)", ""},
           {R"("channels": [8, 16], "memory": 2)", R"("any_beams": true, "scan_memory": true)"},
           {R"("every": 10})", R"("every": 10, "sensor": "drawn"})"},
           {R"("a.npy")", R"("a.npy", "sensor": "hdl-32e", "measured_rows": 8)"},
           {R"("steps")", R"("drawn_from": "vls-128", "steps")"}}) {
    text = replaced_in(text, from, to);
  }
  const TrainingConfiguration c = training_configuration(text, "recipe.json");
  CHECK(c.training.simulated[0].own_sensors);
  CHECK_FALSE(c.validation.simulated[0].own_sensors);
  REQUIRE(c.training.stacks[0].sensor.has_value());
  CHECK(c.training.stacks[0].sensor->sensor.name == "hdl-32e");
  CHECK(c.training.stacks[0].sensor->measured_rows == RowSelection{3, 4});
  CHECK(c.drawn_from->name == "vls-128");
  CHECK_FALSE(c.plan.drawn_from.has_value());  // its scans recall others of the same sensor
}

TEST_CASE("mistakes in a configuration are named with field, expected and found") {
  refuses_recipe("\"steps\": 12", "\"steps\": 0", "recipe.json", "steps is 0");
  refuses_recipe("\"steps\": 12", "\"stepz\": 12", "unknown field 'stepz'");
  refuses_recipe("\"steps\": 12", "\"steps\": \"many\"", "steps", "a number", "many");
  refuses_recipe("\"batch\": 2", "\"batch\": 2.5", "batch", "whole number");
  refuses_recipe("\"crop_columns\": 256", "\"crop_columns\": 4096", "crop_columns is 4096");
  refuses_recipe("\"os1-64\"", "\"os9\"", "recipe.json: network", "'os9'", "none of", "os1-64",
                 "vls-128");
  refuses_recipe("\"os1-64\"", "\"/dev/zero\"", "'/dev/zero'", "none of");
  refuses_recipe("\"measured_rows\": 16", "\"measured_rows\": 4294967312", "measured_rows",
                 "at most a million", "4294967312");
  refuses_recipe("\"seeds\": [3]", "\"seeds\": []", "seeds", "at least one");
  refuses_recipe("[3]", R"({"first": 3, "count": 0})", "seeds", "count", "1 to 100000", "found 0");
  refuses_recipe("[3]", R"({"first": -1, "count": 1})", "first", "found -1");
  refuses_recipe("[3]", R"({"first": 3})", "count", "nothing");
  refuses_recipe("[3]", R"({"first": 3, "count": 1, "last": 3})", "last");
  refuses_recipe("[3]", "3", "seeds", "list of whole numbers");
  refuses_recipe("[3]", R"([3], "conditions": "bad")", "conditions", "usual, varied", "bad");
  refuses_recipe("\"scans\": 10}", "\"scans\": -1}", "scans");
  refuses_recipe("[3]", R"([3], "look_ahead": true)", "look_ahead", "scan_memory");
  refuses_recipe("{\n", "[", "expected JSON");
  refuses_recipe(R"("every": 10})", R"("every": 10, "sensor": "drawn"})", "drawn_from");
  refuses_recipe(R"("stack": "a.npy")",
                 R"("stack": "a.npy", "sensor": "vlp-16", "measured_rows": 4)", "any_beams");
}

TEST_CASE("training and validation never share a drive or a stack") {
  refuses_recipe("\"seeds\": [3]", "\"seeds\": [2]", "town", "seed 2", "expected different");
  refuses_recipe("[3]", R"({"first": 2, "count": 2}, "conditions": "varied")", "town", "seed 2",
                 "expected different");
  refuses_recipe(R"({"drive": "town", "seeds": [3], "scans": 10})", R"({"stack": "a.npy"})",
                 "a.npy", "both");
  // By another name.
  refuses_recipe(R"({"drive": "town", "seeds": [3])", R"({"drive": "town-busy", "seeds": [2])",
                 "that of drive town-busy with seed 2", "both");
  refuses_recipe(R"({"drive": "town", "seeds": [3], "scans": 10})", R"({"stack": "./a.npy"})",
                 "a.npy", "both");
}

}  // namespace hqslam::nn
