#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>

namespace hqslam::slam {

/// Whether an inertial state can begin with the mean specific force over a scan, in the level
/// frame: about gravity's length, upwards.
bool is_gravity(const Eigen::Vector3d& specific_force_mps2);

/// Whether an inertial sensor agrees with the scans, which alone decide: a sensor that is stuck,
/// late, mounted otherwise or in another unit would move every scan.
///
/// The sensor is proven once its turns agree with the registered ones, or scans have fitted clearly
/// better with it, as a hand's do. It is left out once the innovations of its predictions
/// exceed their covariance on average, or its turns or their times differ from the registered ones,
/// and used again when they agree.
class InertialCheck {
 public:
  bool agrees() const { return agrees_; }
  /// Until then a registration without the sensor is taken unless one with it fits clearly better:
  /// wrong turns of a vehicle tilt the map before any fit shows it.
  bool is_proven() const { return is_proven_; }
  /// Whether the path can be levelled by its gravity.
  bool can_level() const { return is_proven_ && !gravity_contradicts_; }
  /// A scan was predicted by the sensor. innovation: normalized_innovation(), or kMostInnovation if
  /// the scan fitted better without the sensor.
  void add_innovation(double innovation);
  /// A scan fitted clearly better with the sensor, which is not proven yet.
  void add_gain();
  /// A registration with a larger innovation competes with one without the sensor.
  static constexpr double kMostInnovation = 12.0;
  /// With a larger one a sensor that is not proven is left out, unless nothing else registers the
  /// scan: a hand at the start of a drive has up to 13, rates in degrees 144 to 257.
  static constexpr double kMostInnovationUnproven = 50.0;
  /// A larger one counts as this, and corrects no bias.
  static constexpr double kMostOfScan = 5.0;
  /// The angular rates since the scan before, in the level frame.
  struct Turn {
    double stamp_s;
    Eigen::Vector3d gyroscope_rad_per_s;  ///< the mean
    Eigen::Vector3d registered_rad_per_s;
  };
  /// A gyroscope's mean difference from the registered turns, and the time over which it is taken.
  struct Bias {
    Eigen::Vector3d rad_per_s;
    double duration_s;
  };
  /// To be called for every registered scan. Returns the bias if the turns prove the sensor now.
  std::optional<Bias> compare_turns(const Turn& turn);
  /// Sets the complaint for a mean specific force that is not is_gravity().
  void complain_about_force(const Eigen::Vector3d& specific_force_mps2);

  /// No path of the scans explains the gravity that was measured along it.
  void contradict_gravity();

  /// What disagrees and what would agree, for a user: "turns disagree with the scans 57-fold;
  /// degrees per second?". Empty as long as nothing did.
  const std::string& complaint() const { return complaint_; }

 private:
  void refute();
  void explain_turns(double measured, double turning, double unexplained, double late_s);

  bool agrees_ = true;
  bool is_proven_ = false;
  bool gravity_contradicts_ = false;
  int gains_ = 0;
  double mean_innovation_ = 0.0;  ///< of about 20 scans
  std::deque<Turn> turns_;
  std::string complaint_;
};

}  // namespace hqslam::slam
