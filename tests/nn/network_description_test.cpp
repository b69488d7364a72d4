#include "hqslam/nn/network_description.h"

#include "hqslam/nn/network_json.h"
#include "small_network.h"

namespace hqslam::nn {
namespace {

std::string message(const HqsPlan& description) {
  return error_message([&] { validate(description); });
}

/// A change that makes a plan invalid, and a part of the error.
struct Spoilt {
  HqsPlan plan;
  void (*spoil)(HqsPlan&);
  const char* said = "";
};

}  // namespace

TEST_CASE("each layer has its own arrays unless weights are shared, penalties come last") {
  std::vector<ParameterShape> shapes = parameter_shapes(small_du_or());
  CHECK(shapes.front().name == "layers.0.encoder.0.weight");
  CHECK(shapes.size() == 3 * 10 + 1);
  CHECK(shapes[10].name == "layers.1.encoder.0.weight");
  CHECK(shapes.back().name == "log_penalty");
  CHECK(shapes.back().shape == std::vector<std::int64_t>{3});
  shapes = parameter_shapes(small_simple_du());
  CHECK(shapes.size() == 5 + 1);
  CHECK(shapes.back().name == "alpha");
  CHECK(shapes.back().shape == std::vector<std::int64_t>{1});
}

TEST_CASE("layers start differently, also from another seed, and penalties at 0.1 or 10.99") {
  for (const HqsPlan& description : {small_du_or(), small_simple_du()}) {
    CHECK(initial_parameters(description, 1) != initial_parameters(description, 2));
  }
  const std::vector<float> parameters = initial_parameters(small_du_or(), 1);
  CHECK(parameters.back() == doctest::Approx(std::log(0.1)));
  CHECK(parameters[0] != parameters[(parameters.size() - 3) / 3]);
  CHECK(initial_parameters(small_simple_du(), 1).back() == 10.99F);
}

TEST_CASE("descriptions that describe no network are refused with the field and the value") {
  const HqsPlan du_or = small_du_or();
  const std::vector<Spoilt> all = {
      {du_or, [](HqsPlan& d) { d.layers = 0; }, "layers is 0"},
      {du_or, [](HqsPlan& d) { d.layers = 21; }, "layers is 21"},
      {du_or, [](HqsPlan& d) { d.range_scale_m = 0.0F; }, "range_scale_m is 0"},
      {du_or, [](HqsPlan& d) { d.range_scale_m = std::nanf(""); }, "range_scale_m"},
      {du_or, [](HqsPlan& d) { d.u_shaped.memory = 513; }, "memory is 513"},
      {small_simple_du(), [](HqsPlan& d) { d.plain.features = 0; }, "features is 0"},
      {du_or, [](HqsPlan& d) { d.sensor.columns = 0; }},
      {du_or, [](HqsPlan& d) { d.u_shaped.channels = {}; }, "0 levels"},
      {du_or, [](HqsPlan& d) { d.u_shaped.channels = {5}; }, "1 levels, expected 2 to 5"},
      {du_or, [](HqsPlan& d) { d.u_shaped.channels.assign(6, 2); }, "6 levels"},
      {du_or, [](HqsPlan& d) { d.u_shaped.channels.assign(100, 2); }},
      {du_or, [](HqsPlan& d) { d.u_shaped.channels[1] = 0; }, "channels is 0"},
      {du_or, [](HqsPlan& d) { d.u_shaped.tile.rows = 0; }, "tile.rows is 0"},
      {du_or, [](HqsPlan& d) { d.u_shaped.memory = -1; }, "memory is -1"},
      {du_or, [](HqsPlan& d) { d.u_shaped.negative_slope = 1.5F; }, "negative_slope is 1.5"},
      {small_simple_du(), [](HqsPlan& d) { d.plain.convolutions = 1; }, "convolutions is 1"},
      {small_simple_du(), [](HqsPlan& d) { d.plain.dropout = 1.0F; }, "dropout is 1"},
      {small_simple_du(), [](HqsPlan& d) { d.plain.dropout = -0.1F; }, "dropout is -0.1"},
      {small_simple_du(), [](HqsPlan& d) { d.plain.dropout = std::nanf(""); }, "dropout is nan"},
      {du_or, [](HqsPlan& d) { d.u_shaped.channels[1] = 2'000'000'000; }},
      {du_or, [](HqsPlan& d) { d.u_shaped.memory = 2'000'000'000; }},
      {du_or, [](HqsPlan& d) { d.u_shaped.tile.rows = d.u_shaped.tile.columns = 1 << 20; }},
      {small_simple_du(), [](HqsPlan& d) { d.plain.features = 2'000'000'000; }},
      {small_simple_du(), [](HqsPlan& d) { d.plain.convolutions = 2'000'000'000; }},
      {du_or, [](HqsPlan& d) { d.last_filter.support_share = 1.0F; }, "support_share is 1"},
      {small_simple_du(), [](HqsPlan& d) { d.last_filter.min_pixels = -1; }, "min_pixels is -1"},
      {du_or, [](HqsPlan& d) { d.filter.min_angle_rad = 0.0; }, "min_angle_rad is 0"},
  };
  for (const Spoilt& each : all) {
    CAPTURE(each.said);
    HqsPlan plan = each.plan;
    CHECK(message(plan) == "no Error");
    each.spoil(plan);
    CHECK(message(plan) != "no Error");
    CHECK(one_line_with(message(plan), each.said));
  }
  const std::vector<std::pair<RowSelection, const char*>> no_rows = {
      {{16, 4}, "rows 16 + n 4 of 16 are no selection"},
      {{0, 2'000'000'000}, "no selection"},
      {{0, 0}, "no selection"},
      {{0, 1}, "all 16 rows of sensor 'small' are measured"}};
  CHECK(refused_with([] { validate(NetworkDescription{}); }, "architecture"));
  for (const auto& [rows, said] : no_rows) {
    HqsPlan plan = du_or;
    plan.measured_rows = rows;
    CHECK(one_line_with(message(plan), said));
  }
}

TEST_CASE("the choices of the loop are written as they are read, and refused otherwise") {
  HqsPlan plan = small_du_or();
  plan.shared = true;
  plan.fixed_penalty = 0.25F;
  plan.filtered_iterate = FilteredIterate::kZ;
  plan.rejected_pixel = RejectedPixel::kZero;
  plan.u_shaped.neighbours_of_h = true;
  const std::string json = network_json(plan);
  CHECK(json.find(R"("neighbours": "h")") != std::string::npos);
  CHECK(json.find(R"("penalty": 0.25)") != std::string::npos);
  CHECK(network_json(network_from_json(json, "a test")) == json);
  const auto message_of = [](const std::string& kind, const std::string& fields) {
    return error_message([&] {
      network_from_json(
          R"({"kind": ")" + kind + R"(", "sensor": "os1-64", "measured_rows": 16, )" + fields + "}",
          "a test");
    });
  };
  CHECK(message_of("du-or", R"("shared_weights": false, "filtered_iterate": "h")") == "no Error");
  CHECK(message_of("simple-du", R"("shared_weights": true, "rejected_pixel": "takes-z")") ==
        "no Error");
  const auto refuses = [&](const char* kind, const char* fields, const auto&... parts) {
    CAPTURE(fields);
    CHECK(one_line_with(message_of(kind, fields), parts...));
  };
  refuses("simple-du", R"("shared_weights": false)", "shared_weights", "true");
  refuses("du-or", R"("filtered_iterate": "y")", "filtered_iterate", "h, z");
  refuses("du-or", R"("penalty": -1)", "penalty", "0 or more");
  refuses("du-or", R"("rejected_pixel": "takes-h")", "rejected_pixel", "takes-z");
  refuses("du-or", R"("start": "zero")", "unknown field 'start'");
  refuses("du-mix", R"("denoiser": {"layers": [{}, {}]})", "layers is 2", "1 to 1");
}

TEST_CASE("networks that take gigabytes are refused, the usual ones on large images are not") {
  HqsPlan simple = small_simple_du();
  simple.plain = {};
  simple.sensor = even_sensor(128, 2048, 28.0, 0.05);
  simple.measured_rows = {3, 4};
  CHECK(message(simple) == "no Error");
  simple.sensor = even_sensor(1024, 16352, 28.0, 0.05);
  simple.layers = 1;
  simple.plain = {.features = 512, .convolutions = 2, .dropout = 0.0F};
  CHECK(one_line_with(message(simple), "1024 x 16352", "values", "at most 536870912"));
  HqsPlan du_or = small_du_or();
  du_or.u_shaped = {.tile = {4, 4}, .channels = {32, 32}, .memory = 16, .negative_slope = 0.0F};
  du_or.sensor = even_sensor(128, 2048, 28.0, 0.05);
  du_or.measured_rows = {3, 4};
  CHECK(message(du_or) == "no Error");
  du_or.u_shaped.tile = {1, 1};
  du_or.u_shaped.channels = {512, 512, 512};
  CHECK(one_line_with(message(du_or), "128 x 2048", "values", "at most 536870912"));
  du_or.u_shaped.channels = {1, 1};
  du_or.u_shaped.memory = 512;
  CHECK(one_line_with(message(du_or), "128 x 2048", "values"));
}

}  // namespace hqslam::nn
