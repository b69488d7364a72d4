#include "hqslam/nn/super_resolver.h"
#include "hqslam/recordings/recording.h"
#include "tools/program/program.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::test {
namespace {

/// A network that trains in a second; `change` replaces text in its configuration.
std::string small_configuration(const std::string& from = "", const std::string& to = "") {
  std::string text = R"({
    "network": {"kind": "du-or", "layers": 2, "sensor": "os1-64", "measured_rows": 16,
                "denoiser": {"channels": [8, 8], "memory": 2}},
    "training": [{"drive": "block", "seeds": [5], "scans": 4, "every": 2}],
    "validation": [{"drive": "block", "seeds": [6], "scans": 1}],
    "steps": 4, "batch": 2, "augmentation": {"crop_columns": 64}, "validate_every": 2
  })";
  return replaced_in(text, from, to);
}

ProgramResult train(const TemporaryDirectory& folder, const std::string& configuration,
                    const std::string& out, const std::string& options = "") {
  write_file(folder.file("recipe.json"), configuration);
  return run_hqslam("train --config '{}' --out '{}' {}", folder.file("recipe.json"),
                    folder.file(out), options);
}

}  // namespace

TEST_CASE("training leaves weights that load, a checkpoint and a learning curve") {
  const TemporaryDirectory folder;
  const ProgramResult first = train(folder, small_configuration(), "a");
  REQUIRE(first.status == 0);
  CHECK(missing(first.out, {"2 training scans, 1 validation scans, from step 0", "step       2/4",
                            "step       4/4"}) == "");
  CHECK_FALSE(holds(first.out, "confidence"));  // which DU-OR does not have
  const nn::Weights weights = nn::read_weights(folder.file("a/weights.npz"));
  CHECK_NOTHROW(nn::SuperResolver::checked(weights, "a"));
  CHECK_FALSE(holds(weights.training, "confidence"));
  CHECK(nlohmann::json::parse(network_json(weights.description))["layers"] == 2);
  CHECK(nlohmann::json::parse(weights.training)["configuration"]["steps"] == 4);
  const nlohmann::json curve = json_of(folder.file("a/curve.json"))["points"];
  CHECK(curve.back()["step"] == 4);
  CHECK(curve.back()["linear"]["mae_all_m"] > 0.0);
  CHECK(fs::exists(folder.file("a/checkpoint.npz")));

  // The same again gives the same bytes; a finished training has nothing left to do.
  REQUIRE(train(folder, small_configuration(), "b").status == 0);
  const std::string bytes = file_contents(folder.file("a/weights.npz"));
  CHECK(file_contents(folder.file("b/weights.npz")) == bytes);
  const ProgramResult again = train(folder, small_configuration(), "a");
  CHECK(again.status == 0);
  CHECK(holds(again.out, "from step 4"));
  CHECK(file_contents(folder.file("a/weights.npz")) == bytes);

  // Another recipe does not go on from this checkpoint.
  CHECK(holds(refusal(train(folder, small_configuration("\"batch\": 2", "\"batch\": 3"), "a")),
              "another training configuration"));
}

TEST_CASE("a training is validated with a stack of the network's own sensor, and no other") {
  const TemporaryDirectory folder;
  const std::string stack =
      R"({"stack": ")" + simulated_drive("--sensor os1-64 --scans 1 --seed 9") + "\"";
  std::string text = small_configuration(R"({"drive": "block", "seeds": [6], "scans": 1})",
                                         stack + R"(, "sensor": "os1-64", "measured_rows": 16})");
  text.replace(text.find(R"("kind")"), text.find("\"training\"") - text.find(R"("kind")"),
               R"("kind": "du-mix", "sensor": "os1-64", "measured_rows": 16, "denoiser":
                  {"any_beams": true,
                   "layers": [{"channels": 8, "lower_channels": 8, "residual_blocks": 1}]}}, )");
  const ProgramResult own = train(folder, text, "own");
  REQUIRE(own.status == 0);
  CHECK_NOTHROW(nn::SuperResolver::checked(nn::read_weights(folder.file("own/weights.npz")), "a"));
  text.replace(text.rfind("\"measured_rows\": 16"), 19, "\"measured_rows\": 32");
  CHECK(holds(refusal(train(folder, text, "other")),
              "validation: expected a drive or stack of the network's own sensor"));
}

TEST_CASE("compare puts interpolation and networks side by side, and the layers of one") {
  const TemporaryDirectory folder;
  REQUIRE(train(folder, small_configuration(), "a").status == 0);
  const std::string weights = folder.file("a/weights.npz");
  const std::string drive = simulated_drive("--sensor os1-64 --scans 2 --seed 9");
  const ProgramResult compared = succeeds("compare '{}' --weights '{}' --json '{}'", drive, weights,
                                          folder.file("table.json"));
  CHECK(missing(compared.out, {"\nnearest ", "\nlinear ", "\ninverse ", "\ndu-or, unfiltered ",
                               "\ndu-or  ", "2 scans of"}) == "");
  const auto table = json_of(folder.file("table.json"));
  REQUIRE(table["methods"].size() == 5);
  CHECK(table["scans"] == 2);
  CHECK(table["methods"][1]["mae_all_m"] > 0.0);

  const auto inner = succeeds("compare '{}' --weights '{}' --layers", drive, weights).out;
  CHECK(missing(inner, {"\nlinear ", "\nlayer 1: H ", "\nlayer 1: Y ", "\nlayer 2: Z "}) == "");
  // The network ends with what it ends with.
  const auto scores_of = [](const std::string& out, const std::string& name) {
    std::istringstream line(out.substr(out.find(name) + name.size(), 80));
    return std::vector<std::string>(std::istream_iterator<std::string>(line), {});
  };
  const std::vector<std::string> of_result = scores_of(inner, "\nresult ");
  const std::vector<std::string> of_network = scores_of(compared.out, "\ndu-or  ");
  REQUIRE(of_result.size() >= 6);
  CHECK(std::equal(of_result.begin(), of_result.begin() + 6, of_network.begin()));
}

TEST_CASE("weights for any sensor go on with a recorded drive, and stay where that is no better") {
  const TemporaryDirectory folder;
  write_sensor_json(preset_with("vlp-16", 256), folder.file("sensor.json"));
  const std::string drive =
      simulated_drive("--sensor '" + folder.file("sensor.json") + "' --scans 110 --seed 9");
  const std::string weights = untrained_file("du-mix", "any_beams");
  const ProgramResult trained =
      succeeds("train --from-recording '{}' --start-from '{}' --steps 40 --out '{}'", drive,
               weights, folder.file("own"));
  CHECK(holds(trained.out, "scans held out: of the pixels between their rows"));
  const nn::Weights own = nn::read_weights(folder.file("own/weights.npz"));
  CHECK_NOTHROW(nn::SuperResolver::checked(own, "own"));
  const bool is_new = holds(trained.out, ": the new weights");
  CHECK((own.parameters == nn::read_weights(weights).parameters) == !is_new);
  CHECK(is_new);  // the old ones are untrained
  const ProgramResult compared = succeeds("compare '{}' --weights '{}' --json '{}'", drive,
                                          folder.file("own/weights.npz"), folder.file("own.json"));
  CHECK(holds(compared.out, "\nlinear "));
  CHECK(holds(compared.out, "\ndu-mix "));
  CHECK(holds(compared.out, "that other scans measured"));
  const nlohmann::json scores = json_of(folder.file("own.json"))["methods"];
  REQUIRE(scores.size() == 4);
  CHECK(scores[1]["over_linear"] == 0.0);
  CHECK(scores[2]["right_share"] > scores[0]["right_share"]);  // inverse, nearest
  CHECK(holds(refused("compare '{}' --every 2", drive), "leave --layers, --poses"));
  const std::string two_scans = simulated_drive("--sensor os1-16 --scans 2 --seed 9");
  CHECK(holds(refusal(run_hqslam("compare '{}'", two_scans)), "expected 20 scans or more"));
  const auto refusal_of = [&](const std::string& recording, const std::string& start) {
    return refusal(run_hqslam("train --from-recording '{}' --start-from '{}' --out '{}'", recording,
                              start, folder.file("none")));
  };
  CHECK(holds(refusal_of(two_scans, weights), "expected at least 100 scans"));
  CHECK(holds(refusal_of(drive, untrained_file("du-mix", "scan_memory")),
              "expected weights without a memory"));
}

TEST_CASE("a scan without a return costs a comparison that scan and no more") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive("--sensor os1-64 --scans 2 --seed 9");
  const RangeImage image = NpyStackReader(drive + "/scans.npy").read(0);
  write_stack(folder.file("gap.npy"), {image, RangeImage(64, 1024), image});
  const ProgramResult compared = succeeds("compare '{}' --sensor os1-64", folder.file("gap.npy"));
  CHECK(holds(compared.out, "2 scans of"));
  CHECK_FALSE(holds(compared.out, "nan"));
  CHECK(holds(compared.error, "1 scan was left out: " + folder.file("gap.npy") +
                                  "[1]: has no return in the measured rows"));
}

TEST_CASE("compare refuses weights of a sensor with as many rows whose beams look elsewhere") {
  CHECK(holds(refused("compare '{}' --weights '{}'", simulated_drive("--sensor hdl-64e --scans 1"),
                      untrained_file()),
              "found weights for 'os1-64'"));
}

TEST_CASE("a network of two modes is trained, and upsamples with a confidence") {
  const TemporaryDirectory folder;
  const std::string recipe = small_configuration(
      R"("kind": "du-or", "layers": 2, "sensor": "os1-64", "measured_rows": 16,
                "denoiser": {"channels": [8, 8], "memory": 2})",
      R"("kind": "du-mix", "sensor": "os1-64", "measured_rows": 16, "denoiser":
         {"layers": [{"channels": 8, "lower_channels": 8, "residual_blocks": 1}]})");
  REQUIRE(train(folder, recipe, "a").status == 0);
  const std::string weights = folder.file("a/weights.npz");
  const nn::NetworkDescription description = nn::read_weights(weights).description;
  CHECK(name(description) == "du-mix");
  CHECK(description.confidence_exponent != 1.0F);
  const std::string drive = simulated_drive("--sensor os1-64 --scans 2 --seed 9");

  const auto upsampled_returns = [&](const std::string& out, const std::string& option) {
    succeeds("upsample '{}' --weights '{}' --out '{}' --pcd {}", drive, weights, folder.file(out),
             option);
    const auto scan = recordings::Recording::open(folder.file(out)).next().value();
    REQUIRE(scan.cloud.confidence.size() == 64 * 1024);
    int computed = 0;
    for (std::size_t i = 0; i < scan.cloud.confidence.size(); ++i) {
      computed += i / 1024 % 4 != 3 && scan.cloud.range_m[i] > 0.0F ? 1 : 0;
    }
    const std::string pcd = file_contents(folder.file(out + "/pcd/000000.pcd"));
    CHECK(holds(pcd, "FIELDS x y z intensity ring timestamp confidence\n"));
    return computed;
  };
  CHECK(upsampled_returns("all", "--confidence 0") > 40'000);
  CHECK(upsampled_returns("none", "--confidence 1") < 100);

  CHECK(holds(refused("upsample '{}' --method linear --confidence 0.5 --out '{}'", drive,
                      folder.file("linear")),
              "du-mix"));
}

}  // namespace hqslam::test
