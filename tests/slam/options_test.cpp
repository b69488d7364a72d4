#include "hqslam/slam/options.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

/// The error of validate().
std::string complaint(const SlamOptions& options) {
  return error_message([&] { hqslam::slam::validate(options); });
}

/// The error of set_option().
std::string complaint_about(std::string_view name, double value) {
  SlamOptions options;
  return error_message([&] { hqslam::slam::set_option(options, name, value); });
}

}  // namespace

TEST_CASE("an invalid or unknown option is named with its value and the constraint") {
  SlamOptions options;
  options.mounting.pitch_rad = 2.0;
  CHECK(complaint(options) ==
        "SLAM option mounting.pitch_rad is 2, expected an angle between -pi/2 and pi/2");
  // All of the map may be matched with, and every residual trusted.
  options = {};
  options.mapping.recent_path_m = std::numeric_limits<double>::max();
  options.mapping.trusted_residual_m = std::numeric_limits<double>::max();
  CHECK(complaint(options) == "no Error");
  using hqslam::test::one_line_with;
  CHECK(one_line_with(complaint_about("mapping.no_such", 1.0),
                      "a SLAM option, found mapping.no_such"));
  for (const double value : {2.5, 1e12}) {
    CHECK(one_line_with(complaint_about("mapping.max_iterations", value), "a whole number"));
  }
}

TEST_CASE("values below the bounds, infinite or NaN are refused for every option, by its name") {
  for (const NamedOption& option : option_table()) {
    CAPTURE(option.name);
    SlamOptions options;
    const double usual = option.get(options);
    const bool is_switch = option.is_whole && option.holds(0.0);
    for (const double value : {-10.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
      CHECK(complaint_about(option.name, value)
                .find(fmt::format("SLAM option {} is ", option.name)) == 0);
      if (is_switch || (option.is_whole && value != -10.0)) continue;
      option.set(options, value);
      CHECK(complaint(options).find(fmt::format("SLAM option {} is ", option.name)) == 0);
      option.set(options, usual);
    }
    if (option.is_whole && !is_switch) CHECK(complaint_about(option.name, 0.0) != "no Error");
  }
}

TEST_CASE("every option is set by its name, and no other with it") {
  std::set<std::string_view> names;
  for (const NamedOption& option : option_table()) {
    CAPTURE(option.name);
    CHECK(names.insert(option.name).second);
    CHECK(!option.meaning.empty());
    SlamOptions options;
    const double other = option.get(options) == 1.0 ? 2.0 : option.is_whole ? 1.0 : 0.75;
    hqslam::slam::set_option(options, option.name, other);
    for (const NamedOption& read : option_table()) {
      CHECK(read.get(options) == (read.name == option.name ? other : read.get(SlamOptions())));
    }
  }
}

TEST_CASE("the table leaves no number of a stage out") {
  std::map<std::string, std::size_t> bytes;
  for (const NamedOption& option : option_table()) {
    const std::string stage(option.name.substr(0, option.name.find('.')));
    bytes[stage] += option.is_whole ? sizeof(int) : sizeof(double);
  }
  const auto whole_doubles = [&](const char* stage) { return (bytes[stage] + 7) / 8 * 8; };
  CHECK(whole_doubles("mounting") == sizeof(SlamOptions::mounting));
  CHECK(whole_doubles("mapping") == sizeof(SlamOptions::mapping));
}

TEST_CASE("options that do not go together, or ask for too much, are refused") {
  const std::pair<void (*)(SlamOptions&), const char*> cases[] = {
      {[](SlamOptions& o) { o.mapping.planar_leaf_m = 0.09; }, "0.1 or more"},
      {[](SlamOptions& o) { o.mapping.located_planar_leaf_m = 0.0005; }, "0.001 or more"},
      {[](SlamOptions& o) { o.threads = -1; }, "threads is -1, expected 0 to 256"},
      {[](SlamOptions& o) { o.threads = 257; }, "threads is 257"},
  };
  for (const auto& [change, says] : cases) {
    SlamOptions options;
    change(options);
    CHECK_THROWS_WITH_AS(hqslam::slam::validate(options), doctest::Contains(says), hqslam::Error);
  }
}
