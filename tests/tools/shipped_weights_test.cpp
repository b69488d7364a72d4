// What the weights that come with the program are worth, on a drive that none of them has seen.

#include <nlohmann/json.hpp>

#include "compare/upsampling_comparison.h"
#include "golden_folder.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/scan_memory.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/sim/drive.h"
#include "testing.h"

namespace hqslam::tools {
namespace {

struct Compared {
  UpsamplingScore linear;
  UpsamplingScore inverse;
  UpsamplingScore network;
};

/// Every 60th of 180 scans of a drive through a town.
Compared compared(const std::string& weights, const char* sensor_name) {
  const SensorModel sensor = sensor_preset(sensor_name);
  const RowSelection rows = selection_for(sensor.rows(), 16);
  std::vector<ComparedMethod> methods;
  for (const nn::Interpolation interpolation :
       {nn::Interpolation::kLinear, nn::Interpolation::kInverse}) {
    methods.push_back({"", {interpolation, sensor, rows}});
  }
  const std::string path = golden_folder() + "/../../weights/" + weights;
  nn::SuperResolver network =
      nn::SuperResolver::load(path, {.architectures = nn::all_architectures()});
  if (fits_any_sensor(network.description())) network = network.for_sensor(sensor, rows);
  methods.push_back({"", {std::move(network), sensor}});
  UpsamplingComparison comparison(std::move(methods));
  sim::DriveSimulator simulator({"town", 4711, 180, {}, {}}, sensor);
  while (const auto scan = simulator.next()) {
    comparison.add(unproject(scan->image, sensor, CaptureTime::kMotionCorrected));
    simulator.skip(59);
  }
  const std::vector<UpsamplingScore> scores = comparison.scores();
  return {scores[0], scores[1], scores[2]};
}

constexpr double kAny = std::numeric_limits<double>::infinity();

/// What a network's figures, as parts of linear interpolation's, stay below; F1 above.
struct Bounds {
  double outliers;
  double f1;
  double mae_valid = kAny;
  double mae_all = kAny;
};

Compared check(const char* weights, const char* sensor_name, const Bounds& bounds) {
  const Compared c = compared(weights, sensor_name);
  const double outliers = c.network.outliers_per_scan / c.linear.outliers_per_scan;
  const double f1 = c.network.f1 / c.linear.f1;
  const double mae_valid = c.network.mae_valid_m / c.linear.mae_valid_m;
  const double mae_all = c.network.mae_all_m / c.linear.mae_all_m;
  MESSAGE(std::string(weights) << ": outliers " << outliers << ", MAE valid " << mae_valid
                               << ", all " << mae_all << ", F1 " << f1 << " of linear's");
  CHECK(outliers < bounds.outliers);
  CHECK(f1 > bounds.f1);
  CHECK(mae_valid < bounds.mae_valid);
  CHECK(mae_all < bounds.mae_all);
  return c;
}

}  // namespace

TEST_CASE("DU-Mix for any sensor has on the OS1 a fifth of linear's outliers and a better cloud") {
  const Compared c = check("du-mix_any-beams.npz", "os1-64", {0.3, 1.15, 0.8});
  CHECK(c.network.outliers_per_scan < 0.4 * c.inverse.outliers_per_scan);
  CHECK(c.network.f1 > c.inverse.f1);
}

TEST_CASE("the network for any sensor has a third of linear's outliers on sensors of all kinds") {
  for (const char* sensor : {"hdl-64e", "hdl-32e", "vlp-32c"}) {
    CAPTURE(sensor);
    check("du-mix_any-beams.npz", sensor, {0.4, 1.08, 0.85});
  }
}

TEST_CASE("DU-OR has a sixth of linear's outliers on the OS1, a third on the HDL-64E") {
  check("du-or_os1_16to64.npz", "os1-64", {0.25, 1.1});
  check("du-or_hdl64e_16to64.npz", "hdl-64e", {0.5, 1.0});
}

TEST_CASE("weights hold the recipe beside them, by which they were trained") {
  for (const char* name : {"du-or_os1_16to64", "du-or_hdl64e_16to64", "du-mix_real-scans"}) {
    CAPTURE(name);
    const std::string path = golden_folder() + "/../../weights/" + name;
    auto trained = nlohmann::json::parse(nn::read_weights(path + ".npz").training)["configuration"];
    const nlohmann::json before = trained;
    trained.merge_patch(nlohmann::json::parse(file_contents(path + ".json")));
    CHECK(trained == before);
  }
}

TEST_CASE("DU-Mix taught by real scans is better than interpolation on simulated ones too") {
  check("du-mix_real-scans.npz", "hdl-64e", {0.25, 1.2});
  check("du-mix_real-scans.npz", "os1-64", {0.25, 1.2});
}

TEST_CASE("the networks to compare with are trained: not far from interpolation, or better") {
  check("srae_4_os1_16to64.npz", "os1-64", {1.5, 0.55});
  check("simple-du_os1_16to64.npz", "os1-64", {1.0, 0.0, 0.8});
}

TEST_CASE("what DU-Mix remembers of the last scans makes its ranges better on an unseen drive") {
  std::string weights = "du-mix-memory_os1_16to64";
  SUBCASE("OS1") {}
  SUBCASE("any sensor") { weights = "du-mix-memory_any-beams"; }
  SUBCASE("OS1, the large one") { weights = "du-mix-memory-large_os1_16to64"; }
  SUBCASE("VLP-16, the large one") { weights = "du-mix-memory-large_vlp16_16to64"; }
  CAPTURE(weights);
  // Every pixel has a range: where less is recalled, more would be left empty.
  const auto load = [&] {
    return nn::SuperResolver::load(fmt::format("{}/../../weights/{}.npz", golden_folder(), weights),
                                   {.least_confidence = 0.0F});
  };
  SensorModel sensor = load().sensor();
  const RowSelection rows = selection_for(sensor.rows(), 16);
  sensor.measured_rows = rows;
  sim::DriveSimulator simulator({"town", 4711, 140, {}, {}}, sensor);
  const auto comparison_of_it = [&] {
    std::vector<ComparedMethod> methods;
    methods.push_back({"", {load(), sensor}});
    return UpsamplingComparison(std::move(methods));
  };
  UpsamplingComparison remembers = comparison_of_it();
  UpsamplingComparison forgets = comparison_of_it();
  nn::ScanMemory memory(sensor);
  simulator.skip(100);
  for (int i = 0; i < 40; ++i) {
    const bool compared = i == 20 || i == 39;
    const auto scan = simulator.next(compared ? std::nullopt : std::optional(rows));
    const RangeImage measured = select_rows(scan->image, rows);
    if (compared) {
      const OrganizedCloud truth = unproject(scan->image, sensor, CaptureTime::kMotionCorrected);
      remembers.add(truth, memory.recall(measured, scan->T_map_sensor_at_column));
      forgets.add(truth);
    }
    memory.insert(unproject(measured, select_rows(sensor, rows), CaptureTime::kRolling),
                  scan->T_map_sensor_at_column, scan->stamp_s);
  }
  const UpsamplingScore with = remembers.scores().front();
  const UpsamplingScore without = forgets.scores().front();
  CHECK(with.mae_valid_m < 0.9 * without.mae_valid_m);
  CHECK(with.f1 > without.f1);
}

}  // namespace hqslam::tools
