#pragma once

#include <Eigen/Core>
#include <deque>
#include <string>

namespace hqslam::slam {

/// Whether an inertial state can begin with the mean specific force over a scan, in the level
/// frame: about gravity's length, upwards.
bool is_gravity(const Eigen::Vector3d& specific_force_mps2);

/// Whether an inertial sensor agrees with the scans, which alone decide: a sensor that is stuck,
/// late, mounted otherwise or in another unit would move every scan.
///
/// The sensor is used from the first scan on, because a hand turns at once. It is left out once the
/// innovations of its predictions exceed their covariance on average, or its turns differ from the
/// registered ones, and used again when they agree.
class InertialCheck {
 public:
  bool agrees() const { return agrees_; }
  /// Until then each registration competes with one without the sensor.
  bool is_proven() const { return predictions_ >= kProving; }
  /// A scan was predicted by the sensor. innovation: normalized_innovation(), or kMostInnovation if
  /// the scan fitted better without the sensor.
  void add_innovation(double innovation);
  /// A registration with a larger innovation competes with one without the sensor.
  static constexpr double kMostInnovation = 12.0;
  /// A larger one counts as this, and corrects no bias.
  static constexpr double kMostOfScan = 5.0;
  /// To be called for every registered scan. In: the angular rates since the scan before, in the
  /// level frame: the gyroscope's mean and the registered one.
  void compare_turns(const Eigen::Vector3d& gyroscope_rad_per_s,
                     const Eigen::Vector3d& registered_rad_per_s);
  /// Sets the complaint for a mean specific force that is not is_gravity().
  void complain_about_force(const Eigen::Vector3d& specific_force_mps2);

  /// What disagrees and what would agree, for a user: "turns disagree with the scans 57-fold;
  /// degrees per second?". Empty as long as nothing did.
  const std::string& complaint() const { return complaint_; }

 private:
  struct Turn {
    Eigen::Vector3d gyroscope_rad_per_s;
    Eigen::Vector3d registered_rad_per_s;
  };
  void refute();
  void explain_turns(double measured, double turning, double unexplained);

  static constexpr int kProving = 20;
  bool agrees_ = true;
  int predictions_ = 0;           ///< since the sensor is used
  double mean_innovation_ = 0.0;  ///< of about 20 scans
  std::deque<Turn> turns_;
  std::string complaint_;
};

}  // namespace hqslam::slam
