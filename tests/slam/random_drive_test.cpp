// Drives of which anything may happen to the sensor, drawn at random.

#include <Eigen/Cholesky>

#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"
#include "slam/village.h"

using slam::Status;

namespace {

/// What happens to a sensor, drawn at random, and what SLAM knew of it.
class RandomDrive {
 public:
  struct Scan {
    std::size_t street = 0;
    Pose T_street_sensor = Pose::Identity();
    bool is_blind = false;
    bool was_carried_blind = false;  ///< some time before, undetectably
    double unseen_s = 0.0;           ///< since the last scan that was not blind
    slam::ScanReport report;
    std::string_view state;
  };

  explicit RandomDrive(unsigned seed) : random_(seed) {
    drive(10);
    while (scans.size() < 60) {
      switch (below(5)) {
        case 0:  // with returns
          drive(1 + below(12));
          break;
        case 1:  // blind
          is_blind_ = true;
          drive(1 + below(12));
          is_blind_ = false;
          break;
        case 2:  // moved, to the other street and back
          street_ = 1 - street_;
          was_carried_blind_ = was_carried_blind_ || scans.back().is_blind;
          drive(below(2) == 0 ? 1 + below(5) : 8 + below(8));
          break;
        case 3: {  // cut: it drives on, and no scans come
          const double cut = 2.0 + below(13);
          time_s_ += 0.1 * cut;
          x_m_ += kStep_m * cut;
          drive(3);
          break;
        }
        default:  // the same scan again and again
          step_m_ = 0.0;
          drive(2 + below(6));
          step_m_ = kStep_m;
      }
    }
    drive(10);
    slam_.finish();
  }

  const slam::Slam& slam() const { return slam_; }
  std::vector<Scan> scans;

 private:
  static constexpr double kStep_m = 0.3;

  int below(unsigned bound) { return static_cast<int>(random_() % bound); }

  void drive(int count) {
    for (int i = 0; i < count; ++i) {
      x_m_ += step_m_;
      time_s_ += 0.1;
      const Pose pose = yard_pose(x_m_, 0.0, 0.0);
      OrganizedCloud cloud = streets_[street_].scan(sensor_, pose);
      if (is_blind_) cloud = OrganizedCloud(cloud.rows, cloud.columns);
      slam::ScanTrace trace;
      const slam::ScanReport report = slam_.process(cloud, time_s_, &trace);
      scans.push_back(
          {street_, pose, is_blind_, was_carried_blind_, time_s_ - seen_s_, report, trace.state});
      if (!is_blind_) seen_s_ = time_s_;
    }
  }

  std::mt19937 random_;
  SensorModel sensor_ = small_sensor(16, 240);
  slam::Slam slam_{sensor_};
  std::array<Village, 2> streets_ = {street(31), street(77)};
  std::size_t street_ = 0;
  bool is_blind_ = false;
  bool was_carried_blind_ = false;
  double x_m_ = 0.0;
  double step_m_ = kStep_m;
  double time_s_ = 0.0;
  double seen_s_ = 0.0;
};

/// Whether the error of a pose is within its covariance (nearly always), or of centimetres.
bool holds(const Eigen::Matrix<double, 6, 6>& covariance, const Pose& T_map_found,
           const Pose& T_map_true) {
  const Twist error = logarithm(T_map_found.inverse() * T_map_true);
  Eigen::Matrix<double, 6, 1> e;
  e << error.linear, error.angular;
  return e.dot(covariance.ldlt().solve(e)) < 60.0 || error.linear.norm() < 0.05;
}

}  // namespace

TEST_CASE("each scan's report is true in random drives with blindness, gaps and carrying") {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const RandomDrive drive(seed);
    const std::vector<std::size_t>& segment_of_scan = drive.slam().segment_of_scan();
    const std::vector<std::size_t> submap_of_scan = drive.slam().submap_of_scan();
    const Trajectory& trajectory = drive.slam().trajectory();
    std::vector<Eigen::Matrix<double, 6, 6>> covariances;
    for (const RandomDrive::Scan& scan : drive.scans) covariances.push_back(scan.report.covariance);
    for (const auto& [i, now] : drive.slam().corrected_covariances()) covariances[i] = now;
    std::size_t missed = 0;
    std::vector<std::optional<std::size_t>> first_of_submap(drive.scans.size());
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      CAPTURE(i);
      const RandomDrive::Scan& scan = drive.scans[i];
      const bool is_registered = slam::is_registered(scan.report.mapping_status);
      missed = is_registered ? 0 : missed + 1;
      // Blind scans are never registered, and registered ones are tracked.
      CHECK(!(scan.is_blind && is_registered));
      if (is_registered) CHECK(scan.state == "tracking");
      // A segment begins with the sixth scan in a row that is missed, or later, and takes with it
      // all of them but the first.
      if (i > 0) CHECK(segment_of_scan[i] >= segment_of_scan[i - 1]);
      if (!is_registered && i > 0 && scan.report.keyframe && scan.state == "tracking") {
        CHECK(missed >= 6);
        CHECK(segment_of_scan[i] == segment_of_scan[i - missed + 2]);
        CHECK(segment_of_scan[i] == segment_of_scan[i - missed] + 1);
        missed = 0;
      }
      // What is known of a pose is true, however little it is; of one in another street nothing is.
      const bool is_known = std::isfinite(covariances[i].trace());
      if (is_registered && segment_of_scan[i] == 0) CHECK(is_known);
      if (is_known && !scan.was_carried_blind) {
        CHECK(scan.street == 0);
        const Pose truth = drive.scans.front().T_street_sensor.inverse() * scan.T_street_sensor;
        CHECK(holds(covariances[i], trajectory[i].T_map_sensor, truth));
      }
      if (!is_registered) continue;
      const bool is_after_gap = scan.report.mapping_status == Status::kAfterGap;
      if (scan.unseen_s > 1.2) CHECK(is_after_gap);
      if (scan.unseen_s < 0.5) CHECK_FALSE(is_after_gap);
      // Relative poses of registered scans of one submap are right.
      std::optional<std::size_t>& first = first_of_submap[submap_of_scan[i]];
      if (!first) first = i;
      const RandomDrive::Scan& other = drive.scans[*first];
      CHECK(scan.street == other.street);
      const Pose truth = other.T_street_sensor.inverse() * scan.T_street_sensor;
      const Pose found = trajectory[*first].T_map_sensor.inverse() * trajectory[i].T_map_sensor;
      CHECK((truth.inverse() * found).translation().norm() < 0.3);
    }
  }
}
