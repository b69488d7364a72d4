#include "imu/imu_buffer.h"

#include <Eigen/Geometry>

#include "testing.h"

using namespace hqslam::slam;

namespace {

const Eigen::Matrix3d kLevel = Eigen::Matrix3d::Identity();

/// Every 10 ms from `first` on, the rate about x being the sample's number.
std::vector<ImuSample> samples(int first, int last) {
  std::vector<ImuSample> result;
  for (int k = first; k <= last; ++k) {
    result.push_back({0.01 * k, {1.0 * k, 0, 0}, {0, 2.0 * k, 0}});
  }
  return result;
}

ImuBuffer buffer_of(const std::vector<ImuSample>& samples) {
  ImuBuffer buffer;
  buffer.add(samples);
  return buffer;
}

}  // namespace

TEST_CASE("a sample holds from midway after the one before to midway before the next") {
  const std::vector<ImuStep> steps = buffer_of(samples(0, 10)).steps(0.02, 0.047, kLevel);
  REQUIRE(steps.size() == 4);
  const double durations_s[] = {0.005, 0.01, 0.01, 0.002};
  for (int i = 0; i < 4; ++i) {
    CHECK(steps[i].duration_s == doctest::Approx(durations_s[i]));
    CHECK(steps[i].angular_rate_rad_per_s.x() == 2.0 + i);
  }
  // (0.005 4 + 0.01 6 + 0.01 8 + 0.002 10) / 0.027
  CHECK(slam::mean_specific_force_mps2(steps).y() == doctest::Approx(0.18 / 0.027));
}

TEST_CASE("steps are turned to the level sensor") {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitZ()).matrix();
  const std::vector<ImuStep> steps = buffer_of(samples(1, 3)).steps(0.02, 0.021, R);
  REQUIRE(steps.size() == 1);
  CHECK(steps[0].angular_rate_rad_per_s.isApprox(Eigen::Vector3d(0, 2, 0)));
  CHECK(steps[0].specific_force_mps2.isApprox(Eigen::Vector3d(-4, 0, 0)));
}

TEST_CASE("nothing is integrated over missing samples, but for 50 ms") {
  ImuBuffer buffer = buffer_of(samples(0, 10));
  buffer.add(samples(14, 20));
  CHECK(buffer.steps(0.05, 0.18, kLevel).size() > 10);
  CHECK(buffer.steps(0.05, 0.24, kLevel).size() > 10);
  CHECK(buffer.steps(0.05, 0.26, kLevel).empty());
  CHECK(buffer.steps(-0.04, 0.02, kLevel).size() > 1);
  CHECK(buffer.steps(-0.06, 0.02, kLevel).empty());
  buffer.add(samples(26, 30));
  CHECK(buffer.steps(0.05, 0.28, kLevel).empty());
  CHECK(ImuBuffer().steps(0.0, 0.1, kLevel).empty());
}

TEST_CASE("samples that are no numbers, or come late, are left out") {
  constexpr double kNot = std::numeric_limits<double>::quiet_NaN();
  ImuBuffer buffer = buffer_of({{kNot, {0, 0, 0}, {0, 0, 0}}});
  CHECK(buffer.steps(0.01, 0.08, kLevel).empty());
  buffer.add(samples(0, 5));
  buffer.add(samples(3, 4));
  buffer.add({{0.06, {kNot, 0, 0}, {0, 0, 0}}});
  buffer.add({{0.06, {0, 0, 0}, {0, 0, std::numeric_limits<double>::infinity()}}});
  buffer.add({{kNot, {0, 0, 0}, {0, 0, 0}}});
  buffer.add(samples(7, 9));
  double sum_s = 0.0;
  for (const ImuStep& step : buffer.steps(0.01, 0.08, kLevel)) {
    CHECK(step.angular_rate_rad_per_s.allFinite());
    sum_s += step.duration_s;
  }
  CHECK(sum_s == doctest::Approx(0.07));
  // And such as no sensor can have measured.
  for (const double value : {1e200, 2e3, -std::numeric_limits<double>::infinity()}) {
    std::vector<ImuSample> spiked = samples(0, 10);
    spiked.insert(spiked.begin() + 5, {0.045, {0, 0, value}, {0, 0, 9.8}});
    spiked.insert(spiked.begin() + 5, {0.044, {0, 0, 0}, {value, 0, 9.8}});
    CHECK(buffer_of(spiked).steps(0.0, 0.1, kLevel).size() == 11);
  }
}

TEST_CASE("samples that are dropped are not needed later") {
  ImuBuffer buffer = buffer_of(samples(0, 20));
  const std::vector<ImuStep> before = buffer.steps(0.103, 0.15, kLevel);
  buffer.forget_before(0.103);
  const std::vector<ImuStep> after = buffer.steps(0.103, 0.15, kLevel);
  REQUIRE(after.size() == before.size());
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(after[i].duration_s == before[i].duration_s);
  CHECK(buffer.steps(0.02, 0.05, kLevel).empty());
}

TEST_CASE("a stamp of the future does not keep out later samples") {
  std::vector<ImuSample> later = samples(11, 20);
  later.front().stamp_s = 5e9;
  later[1].stamp_s = 5e9 + 0.01;
  ImuBuffer buffer = buffer_of(samples(0, 10));
  buffer.add(later);
  CHECK(buffer.steps(0.05, 0.2, kLevel).size() > 10);
}

TEST_CASE("a single rate far from its neighbours becomes their mean, a lasting one stays") {
  std::vector<ImuSample> spiked = samples(0, 10);
  spiked[5].angular_rate_rad_per_s.z() = 35.0;
  const std::vector<ImuStep> steps = buffer_of(spiked).steps(0.0, 0.1, kLevel);
  REQUIRE(steps.size() == 11);
  CHECK(steps[5].angular_rate_rad_per_s == Eigen::Vector3d(5, 0, 0));
  spiked[6].angular_rate_rad_per_s.z() = 35.0;
  CHECK(buffer_of(spiked).steps(0.0, 0.1, kLevel)[5].angular_rate_rad_per_s.z() == 35.0);
}
