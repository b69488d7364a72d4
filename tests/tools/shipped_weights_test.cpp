// What the weights that come with the program are worth, on a drive that none of them has seen.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "golden_folder.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/sim/drive.h"
#include "laboratory/compare/upsampling_comparison.h"

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
    methods.push_back({"", nn::Upsampler(interpolation, sensor, rows), std::nullopt});
  }
  const std::string path = golden_folder() + "/../../weights/" + weights;
  methods.push_back({"", nn::Upsampler(nn::SuperResolver::load(path), sensor), std::nullopt});
  UpsamplingComparison comparison(std::move(methods));
  sim::DriveSpec spec = sim::drive_preset("town");
  spec.seed = 4711;
  spec.scans = 180;
  sim::DriveSimulator simulator(spec, sensor);
  while (const auto scan = simulator.next()) {
    comparison.add(unproject(scan->image, sensor, CaptureTime::kMotionCorrected));
    simulator.skip(59);
  }
  const std::vector<UpsamplingScore> scores = comparison.scores();
  return {scores[0], scores[1], scores[2]};
}

}  // namespace

TEST_CASE("DU-Mix for the OS1 has a fifth of linear interpolation's outliers and a better cloud") {
  const Compared c = compared("du-mix_os1_16to64.npz", "os1-64");
  MESSAGE("outliers " << c.network.outliers_per_scan / c.linear.outliers_per_scan << ", MAE valid "
                      << c.network.mae_valid_m / c.linear.mae_valid_m << ", F1 "
                      << c.network.f1 / c.linear.f1 << " of linear's");
  CHECK(c.network.outliers_per_scan < 0.3 * c.linear.outliers_per_scan);
  CHECK(c.network.mae_valid_m < 0.8 * c.linear.mae_valid_m);
  CHECK(c.network.f1 > 1.15 * c.linear.f1);
  CHECK(c.network.outliers_per_scan < 0.4 * c.inverse.outliers_per_scan);
  CHECK(c.network.f1 > c.inverse.f1);
}

TEST_CASE("DU-OR for the OS1 has a sixth of linear interpolation's outliers") {
  const Compared c = compared("du-or_os1_16to64.npz", "os1-64");
  MESSAGE("outliers " << c.network.outliers_per_scan / c.linear.outliers_per_scan << ", F1 "
                      << c.network.f1 / c.linear.f1 << " of linear's");
  CHECK(c.network.outliers_per_scan < 0.25 * c.linear.outliers_per_scan);
  CHECK(c.network.f1 > 1.1 * c.linear.f1);
}

TEST_CASE("DU-Mix for the HDL-64E is better than interpolation on simulated scans too") {
  const Compared c = compared("du-mix_hdl64e_16to64.npz", "hdl-64e");
  MESSAGE("outliers " << c.network.outliers_per_scan / c.linear.outliers_per_scan << ", MAE valid "
                      << c.network.mae_valid_m / c.linear.mae_valid_m << ", F1 "
                      << c.network.f1 / c.linear.f1 << " of linear's");
  CHECK(c.network.outliers_per_scan < 0.25 * c.linear.outliers_per_scan);
  CHECK(c.network.f1 > 1.2 * c.linear.f1);
}

TEST_CASE(
    "DU-OR for the HDL-64E has a third of linear interpolation's outliers on simulated scans") {
  const Compared c = compared("du-or_hdl64e_16to64.npz", "hdl-64e");
  MESSAGE("outliers " << c.network.outliers_per_scan / c.linear.outliers_per_scan << ", F1 "
                      << c.network.f1 / c.linear.f1 << " of linear's");
  CHECK(c.network.outliers_per_scan < 0.5 * c.linear.outliers_per_scan);
  CHECK(c.network.f1 > c.linear.f1);
}

TEST_CASE("the networks to compare with are trained: not far from interpolation, or better") {
  nn::add_compared_networks();
  const Compared srae = compared("srae_4_os1_16to64.npz", "os1-64");
  MESSAGE("SRAE: outliers " << srae.network.outliers_per_scan / srae.linear.outliers_per_scan
                            << ", F1 " << srae.network.f1 / srae.linear.f1 << " of linear's");
  CHECK(srae.network.outliers_per_scan < 1.5 * srae.linear.outliers_per_scan);
  CHECK(srae.network.f1 > 0.55 * srae.linear.f1);
  const Compared tulip = compared("tulip_16_os1_16to64.npz", "os1-64");
  MESSAGE("TULIP: MAE all " << tulip.network.mae_all_m / tulip.linear.mae_all_m << ", F1 "
                            << tulip.network.f1 / tulip.linear.f1 << " of linear's");
  CHECK(tulip.network.mae_all_m < tulip.linear.mae_all_m);
  CHECK(tulip.network.f1 > 0.7 * tulip.linear.f1);
  const Compared simple_du = compared("simple-du_os1_16to64.npz", "os1-64");
  MESSAGE("Simple DU: MAE valid " << simple_du.network.mae_valid_m / simple_du.linear.mae_valid_m
                                  << ", outliers "
                                  << simple_du.network.outliers_per_scan /
                                         simple_du.linear.outliers_per_scan
                                  << " of linear's");
  CHECK(simple_du.network.mae_valid_m < 0.8 * simple_du.linear.mae_valid_m);
  CHECK(simple_du.network.outliers_per_scan < simple_du.linear.outliers_per_scan);
}

}  // namespace hqslam::tools
