#include "hqslam/nn/instruction_set.h"
#include "tools/program/program.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::test {

TEST_CASE("bench measures every stage with 64, 16 and 16 upsampled rows, with one thread and two") {
  const ProgramResult result = succeeds("bench --scans 12 --json --weights '{}'", untrained_file());
  const nlohmann::json json = nlohmann::json::parse(result.out);
  REQUIRE(json["slam"].size() == 6);
  for (const nlohmann::json& timing : json["slam"]) {
    CHECK(timing["scans"] == 12);
    const bool is_upsampled = timing["upsampled_by"] == "du-or";
    CHECK(is_upsampled == timing["upsampling_ms"].is_object());
    if (is_upsampled) {
      CHECK(timing["rows"] == 16);
      CHECK(timing["stages_ms"]["total"]["median"] > timing["upsampling_ms"]["median"]);
    }
    for (const char* stage : {"segmentation", "features", "mapping", "total"}) {
      CHECK(timing["stages_ms"][stage]["median"] > 0.0);
    }
    CHECK(timing["stages_ms"]["odometry"]["median"] >= 0.0);  // it runs where it can change a pose
  }
  const std::size_t sets = nn::available_instruction_sets().size();
  REQUIRE(json["networks"].size() == 1);
  const nlohmann::json& network = json["networks"][0];
  CHECK(network["network"] == "du-or");
  CHECK(network["gmac"] > 0.01);
  REQUIRE(network["runs"].size() == 2 * sets);
  for (const nlohmann::json& run : network["runs"]) {
    CHECK(run["frames_per_second"] > 0.0);
    CHECK(run["gflops"] > 0.0);
  }
}

TEST_CASE("bench --cpu prints the instruction set in use, which the environment may choose") {
  const nlohmann::json json = nlohmann::json::parse(succeeds("bench --cpu --json").out);
  CHECK(json["instruction_set"] == nn::name(nn::chosen_instruction_set()));
  CHECK(json["available"].size() == nn::available_instruction_sets().size());
  setenv("HQSLAM_INSTRUCTION_SET", "portable", 1);
  CHECK(holds(run_hqslam("bench --cpu").out, "in use:    portable"));
  setenv("HQSLAM_INSTRUCTION_SET", "mmx", 1);
  refused("bench --cpu");
  unsetenv("HQSLAM_INSTRUCTION_SET");
}

}  // namespace hqslam::test
