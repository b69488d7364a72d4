#include "hqslam/nn/network.h"

#include "hqslam/nn/network_json.h"
#include "small_network.h"

// What holds for every network, whatever it is.
namespace hqslam::nn {
namespace {

std::vector<NetworkDescription> every_kind() {
  return {small_du_or(), small_simple_du(), small_du_mix()};
}

/// A scan of `columns` columns, `times` side by side.
RangeImage repeated_scan(int columns, int times) {
  return made_image(4, columns * times, [=](int row, int column) {
    return 5 + (row * 37 + column % columns * 11) % 23;
  });
}

UpsampledImage upsampled(NetworkDescription description, const RangeImage& measured) {
  description.sensor.columns = 26 * 8;  // of which these are some, or all
  return made(description, initial_parameters(description, 5), 1, chosen_instruction_set(),
              measured.columns)
      ->upsample(measured, 0.5F);
}

}  // namespace

TEST_CASE("every kind in the table is read by its name alone and writes what it reads") {
  std::set<std::string> names;
  for (const NamedArchitecture& named : hqs_architectures()) {
    const std::string text = std::string(R"({"kind": ")") + named.name +
                             R"(", "sensor": "os1-64", "measured_rows": 16})";
    const NetworkDescription description = network_from_json(text, "test");
    CHECK(name(description) == named.name);
    CHECK(network_json(network_from_json(network_json(description), "again")) ==
          network_json(description));
    CHECK(static_cast<std::int64_t>(initial_parameters(description, 1).size()) ==
          elements(parameter_shapes(description)));
    names.insert(named.name);
  }
  CHECK(names.size() == hqs_architectures().size());
}

TEST_CASE("images may have any number of columns that the strides divide, down to one of them") {
  for (const NetworkDescription& description : every_kind()) {
    const int multiple = description.architecture->column_multiple();
    CHECK(multiple == (name(description) == "simple-du" ? 1 : 8));
    for (const int columns : {multiple, 3 * multiple, 5 * multiple, 13 * multiple}) {
      CAPTURE(name(description));
      CAPTURE(columns);
      const UpsampledImage once = upsampled(description, repeated_scan(columns, 1));
      REQUIRE(once.image.columns == columns);
      for (const float range_m : once.image.range_m) REQUIRE(std::isfinite(range_m));
      if (multiple == 1) continue;  // it does not go round
      // A scan that stands twice on a circle is upsampled to what stands there twice.
      const UpsampledImage twice = upsampled(description, repeated_scan(columns, 2));
      for (int row = 0; row < 16; ++row) {
        for (int column = 0; column < 2 * columns; ++column) {
          REQUIRE(twice.image.at(row, column) ==
                  doctest::Approx(once.image.at(row, column % columns)).epsilon(1e-5));
        }
      }
    }
    if (multiple == 1) continue;
    NetworkDescription other = description;
    other.sensor.columns = 60;
    CHECK(refused_with([&] { validate(other); }, "60", "multiple"));
    for (const int columns : {multiple - 1, multiple + 1, 3 * multiple + multiple / 2}) {
      CHECK(refused_with([&] { upsampled(description, RangeImage(4, columns)); },
                         std::to_string(columns), "multiple"));
    }
  }
}

TEST_CASE("columns, threads, instruction sets and parameters that cannot be are refused") {
  for (const NetworkDescription& description : every_kind()) {
    const auto refuses = [&](int columns, int instruction_set, int threads, const auto&... parts) {
      const auto set = static_cast<InstructionSet>(instruction_set);
      CHECK(refused_with([&] { make_network(description, columns, set, threads); }, parts...));
    };
    const int chosen = static_cast<int>(chosen_instruction_set());
    const int beyond_all = static_cast<int>(InstructionSet::kAvx512) + 1;
    refuses(0, chosen, 1, "0 columns", "1 to 64");
    refuses(128, chosen, 1, "128 columns", "1 to 64");
    refuses(64, beyond_all, 1, "instruction set", "portable");
    for (const int threads : {-1, 0, 1025, 1 << 30}) {
      refuses(64, chosen, threads, "threads is " + std::to_string(threads), "1 to 1024");
    }
    std::vector<float> parameters = initial_parameters(description, 1);
    const std::string expected = std::to_string(parameters.size());
    parameters.pop_back();
    CHECK(refused_with([&] { made(description, parameters); }, std::to_string(parameters.size()),
                       expected));
  }
}

TEST_CASE("every kind gives the same bytes with any number of threads and instruction set") {
  HqsPlan filtered = small_du_or();
  filtered.filter.min_pixels = 30;
  std::vector<NetworkDescription> kinds = every_kind();
  kinds.push_back(filtered);
  for (const NetworkDescription& description : kinds) {
    const RangeImage measured = measured_scene(description);
    const std::vector<float> parameters = large_parameters(description, 1);
    for (const InstructionSet set : available_instruction_sets()) {
      CAPTURE(name(description));
      CAPTURE(name(set));
      const auto expected = made(description, parameters, 1, set)->upsample(measured, 0.5F);
      for (const int threads : {2, 3, 5}) {
        const UpsampledImage found =
            made(description, parameters, threads, set)->upsample(measured, 0.5F);
        CHECK(found.image.range_m == expected.image.range_m);
        CHECK(found.confidence == expected.confidence);
      }
    }
  }
}

}  // namespace hqslam::nn
