#include "hqslam/core/npz.h"
#include "tools/page_data.h"
#include "tools/program/program.h"
#include "tools/program/untrained_weights.h"

// What inspect shows of a network beside the page of its layers.
namespace hqslam::test {
namespace {

/// A scan of a sensor with few columns, so that the reference takes a second, and weights for it.
struct Inspected {
  TemporaryDirectory folder;
  std::string page = folder.file("page.html");

  Inspected() {
    const SensorModel sensor = preset_with("os1-64", 128);
    nn::Weights weights = untrained_weights(sensor, "du-mix");
    weights.description.least_confidence = 0.9F;  // it empties nearly everything
    write_weights(folder.file("weights.npz"), weights);
    write_file(folder.file("sensor.json"), sensor_json(sensor));
    run_hqslam("simulate --drive block --sensor '{0}/sensor.json' --scans 1 --out '{0}/drive'",
               folder.path());
  }
  /// To inspect it with these options.
  std::string by(const std::string& options) const {
    return fmt::format("inspect '{0}/drive' --weights '{0}/weights.npz' {1}", folder.path(),
                       options);
  }
};

}  // namespace

TEST_CASE("inspect and compare take weights that come with hqslam by their name") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive("--sensor vlp-32c --scans 1 --seed 9");
  succeeds("inspect '{}' --weights du-mix --out '{}'", drive, folder.file("page.html"));
  CHECK(holds(file_contents(folder.file("page.html")), "du-mix_any-beams.npz"));
  CHECK(holds(succeeds("compare '{}' --weights du-mix", drive).out, "\ndu-mix "));
  // On scans of any number of columns.
  write_sensor_json(preset_with("hdl-32e", 270), folder.file("sensor.json"));
  succeeds("simulate --drive block --sensor '{0}/sensor.json' --scans 1 --out '{0}/drive'",
           folder.path());
  CHECK(holds(succeeds("compare '{}' --weights du-mix", folder.file("drive")).out, "\ndu-mix "));
}

TEST_CASE("inspect --list prints every tensor with its shape and unit, and writes nothing") {
  const Inspected inspected;
  const ProgramResult result = succeeds(inspected.by("--list"));
  CHECK(missing(result.out, {"measured  1 x 16 x 128  m\n", "layers.0.encoder.0  8 x 16 x 32  \n",
                             "confidence  1 x 64 x 128  \n"}) == "");
  CHECK_FALSE(fs::exists(inspected.page));
  refused(inspected.by(fmt::format("--list --out '{}'", inspected.page)));
}

TEST_CASE("inspect prints the figures of layers; --npz writes every tensor that --list names") {
  const Inspected inspected;
  const std::string tensors = inspected.folder.file("tensors.npz");
  CHECK(missing(succeeds(inspected.by(fmt::format("--npz '{}' --pixel 5,7", tensors))).out,
                {"|D H - L|", "\nLayer 1 ", "\nResult ", "pixel 5,7: "}) == "");
  const NpzArrays arrays = read_npz(tensors);
  const std::string names = succeeds(inspected.by("--list")).out;
  CHECK(std::ssize(arrays) == std::ranges::count(names, '\n'));
  for (const auto& [name, array] : arrays) CHECK(holds("\n" + names, "\n" + name + "  "));
  CHECK(arrays.at("layers.0.z").shape == std::vector<std::int64_t>{1, 64, 128});
  // It is the recording.
  refused(inspected.by(fmt::format("--npz '{}'", inspected.folder.file("weights.npz"))));
  for (const auto& [options, says] :
       {std::pair("--npz t.html", "ends with .npz"),
        {"--pixel 8.7,3", "whole numbers ROW,COLUMN"},
        {"--tensor layers.7.h --out none.html", "did you mean 'layers.0.h'"},
        {"--out tensors_of_no_page.npz", "--npz tensors_of_no_page.npz writes the tensors"}}) {
    CHECK(holds(refused(inspected.by(options)), says));
  }
}

TEST_CASE("inspect --reference finds differences of arithmetic alone, also in what is emptied") {
  const Inspected inspected;
  const ProgramResult result = succeeds(inspected.by(
      fmt::format("--reference --tensor layers.0.encoder.0 --out '{}'", inspected.page)));
  for (const std::string name :
       {"layers.0.encoder.0", "layers.0.decoder.0", "weight_1", "probability", "confidence"}) {
    CAPTURE(name);
    const std::size_t line = result.out.find("\n" + name + " ");
    REQUIRE(line != std::string::npos);
    CHECK(std::stod(result.out.substr(line + 1 + name.size())) < 1e-3);
  }
  const nlohmann::json page = data_of(file_contents(inspected.page));
  CHECK_FALSE(page["differences"].empty());
  const auto is_shown = [](const auto& image) { return image["group"] == "layers.0.encoder.0"; };
  CHECK(std::ranges::count_if(page["images"], is_shown) == 8);  // the tensor's channels
}

}  // namespace hqslam::test
