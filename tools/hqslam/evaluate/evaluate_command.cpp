#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "hqslam/core/angles.h"
#include "hqslam/core/cloud_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/point_fields.h"
#include "hqslam/core/projection.h"
#include "hqslam/evaluation/cloud_error.h"
#include "hqslam/evaluation/image_error.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "product.h"
#include "recording/reference.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct EvaluateOptions {
  std::string estimate;
  std::string reference;
  std::string alignment = "se3";
  std::string sensor;  ///< of two .npy stacks: adds the errors in 3-D
};

constexpr std::array<double, 3> kStretches_m = {10.0, 100.0, 800.0};

void print_row(std::string_view label, const Statistics& statistics, double scale) {
  to_stdout("{:<26}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}\n", label, scale * statistics.rmse,
            scale * statistics.mean, scale * statistics.median, scale * statistics.max);
}

/// The same trajectory if its file has quaternions as w x y z, not as x y z w.
Trajectory read_with_w_first(Trajectory poses) {
  for (StampedPose& pose : poses) {
    const Eigen::Quaterniond read(pose.T_map_sensor.linear());
    pose.T_map_sensor.linear() =
        Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).toRotationMatrix();
  }
  return poses;
}

/// Names the file whose rotations agree with the other's once they are read as w x y z.
void warn_of_w_first(const EvaluateOptions& options, const Trajectory& estimate,
                     const Trajectory& reference, Alignment alignment, double median_rad) {
  constexpr double kDoubtful_rad = 20.0 * kDegree_rad;
  constexpr double kShareLeft = 0.2;
  if (median_rad < kDoubtful_rad) return;
  const auto warn_if = [&](const std::string& path, const Trajectory& first,
                           const Trajectory& second) {
    const AbsolutePoseError ape = absolute_pose_error(first, second, alignment);
    if (ape.rotation_statistics.median > kShareLeft * median_rad) return;
    to_stderr("hqslam: {}: its rotations agree only if read as qw qx qy qz; write qx qy qz qw\n",
              path);
  };
  warn_if(options.estimate, read_with_w_first(estimate), reference);
  warn_if(options.reference, estimate, read_with_w_first(reference));
}

int evaluate_trajectories(const EvaluateOptions& options) {
  const TrajectoryFile estimate_file = read_trajectory_file(options.estimate);
  const TrajectoryFile reference_file = read_trajectory_file(options.reference);
  const Trajectory estimate = with_stamps_of(estimate_file, reference_file.poses);
  const Trajectory reference = with_stamps_of(reference_file, estimate_file.poses);
  const Alignment alignment = alignment_from_name(options.alignment);
  const AbsolutePoseError ape = absolute_pose_error(estimate, reference, alignment);
  to_stdout("{} of {} poses paired with {}, {:.1f} m of path\n", ape.translation_m.size(),
            estimate.size(), options.reference, path_length_m(reference));
  to_stdout("{:<26}{:>10}{:>10}{:>10}{:>10}\n", "", "RMSE", "mean", "median", "max");
  print_row(fmt::format("APE m (align {})", options.alignment), ape.translation_statistics, 1.0);
  if (const std::string units = complaint_about_units(estimate, reference, ape.pairs);
      !units.empty()) {
    to_stderr("hqslam: {}: {}\n", options.reference, units);
  }
  const std::string rotation = fmt::format("APE deg (align {})", options.alignment);
  if (ape.is_rotation_known) {
    print_row(rotation, ape.rotation_statistics, kDegreesPerRadian);
    warn_of_w_first(options, estimate, reference, alignment, ape.rotation_statistics.median);
  } else {
    to_stdout("{:<26}{:>10}  {}\n", rotation, "-",
              "(not determined by so straight a path; --align first gives it)");
  }
  for (const double stretch_m : kStretches_m) {
    const RelativePoseError rpe = relative_pose_error(estimate, reference, stretch_m);
    if (rpe.translation_m.empty()) continue;
    print_row(fmt::format("RPE % over {:.0f} m", stretch_m), rpe.translation_statistics,
              100.0 / stretch_m);
    print_row(fmt::format("RPE deg/100 m over {:.0f} m", stretch_m), rpe.rotation_statistics,
              kDegreesPerRadian * 100.0 / stretch_m);
  }
  const std::size_t slipped = slips(estimate, reference).size();
  const Trajectory compared(
      reference.begin() + static_cast<std::ptrdiff_t>(ape.pairs.reference.front()),
      reference.begin() + static_cast<std::ptrdiff_t>(ape.pairs.reference.back()) + 1);
  to_stdout("{:<26}{:>10}{:>10.1f} per 100 km\n", "slips", slipped,
            slips_per_100_km(slipped, path_length_m(compared)));
  return kOk;
}

void print_cloud_error(const CloudError& error) {
  to_stdout("Chamfer distance      {:.4f} m^2\n", error.chamfer_m2);
  to_stdout("voxel IoU at 0.1 m    {:.4f}\n", error.iou);
  to_stdout("voxel precision       {:.4f}\n", error.precision);
  to_stdout("voxel recall          {:.4f}\n", error.recall);
  to_stdout("voxel F1 at 0.1 m     {:.4f}\n", error.f1);
  to_stdout("outlier points        {:.2f} %\n", 100.0 * error.outlier_share);
}

int evaluate_clouds(const EvaluateOptions& options) {
  const CloudError error =
      cloud_error(read_cloud(options.estimate).points_m, read_cloud(options.reference).points_m);
  print_cloud_error(error);
  return kOk;
}

/// Sums over the images of two stacks.
struct StackErrors {
  double mae_all_m = 0.0;
  double valid_sum_m = 0.0;
  std::int64_t valid_pixels = 0;
  CloudError cloud;  ///< sums until divided
  std::int64_t images_with_points = 0;
};

void add_image(StackErrors& sums, const RangeImage& image, const RangeImage& true_image,
               const std::optional<SensorModel>& sensor) {
  const ImageError error = image_error(image, true_image);
  sums.mae_all_m += error.mae_all_m;
  sums.valid_sum_m += error.mae_valid_m * static_cast<double>(error.valid_pixels);
  sums.valid_pixels += error.valid_pixels;
  if (!sensor) return;
  const std::vector<Eigen::Vector3f> points_m =
      points_of(unproject(image, *sensor, CaptureTime::kMotionCorrected));
  const std::vector<Eigen::Vector3f> true_points_m =
      points_of(unproject(true_image, *sensor, CaptureTime::kMotionCorrected));
  if (!points_m.empty() && !true_points_m.empty()) {
    sums.cloud += cloud_error(points_m, true_points_m);
    ++sums.images_with_points;
  }
}

int evaluate_stacks(const EvaluateOptions& options) {
  NpyStackReader estimate(options.estimate);
  NpyStackReader reference(options.reference);
  if (estimate.images() != reference.images()) {
    throw Error("{}: has {} images, but {} has {}; give two stacks of the same scans",
                options.estimate, estimate.images(), options.reference, reference.images());
  }
  if (estimate.images() == 0) {
    throw Error("{}: has no image; give a stack with at least one", options.estimate);
  }
  std::optional<SensorModel> sensor;
  if (!options.sensor.empty()) sensor = load_sensor(options.sensor);
  StackErrors sums;
  for (std::int64_t i = 0; i < estimate.images(); ++i) {
    add_image(sums, estimate.read(i), reference.read(i), sensor);
  }
  to_stdout("{} images of {} x {}, means over all images\n", estimate.images(), estimate.rows(),
            estimate.columns());
  to_stdout("MAE, all pixels       {:.4f} m\n",
            sums.mae_all_m / static_cast<double>(estimate.images()));
  to_stdout("MAE, valid pixels     {:.4f} m ({} pixels)\n",
            sums.valid_pixels > 0 ? sums.valid_sum_m / static_cast<double>(sums.valid_pixels) : 0.0,
            sums.valid_pixels);
  if (sums.images_with_points > 0) {
    sums.cloud /= static_cast<double>(sums.images_with_points);
    print_cloud_error(sums.cloud);
  } else if (!sensor) {
    to_stdout("(--sensor adds Chamfer distance, IoU, F1 and outliers in 3-D)\n");
  }
  return kOk;
}

constexpr const char* kDefinitions =
    R"(Definitions
  APE      absolute pose error: distance and angle of E = T_reference^-1
           T_estimate for each pair of poses, as in evo (evo_ape), after an
           alignment: se3 (least squares of all positions, Umeyama 1991, no
           scale), first (the first poses made equal) or none. Pairs are the
           stamps at most 0.02 s apart. KITTI files have none: pose i is that of
           the other file, which must have as many poses.
  RPE      relative pose error: the same of the motion over stretches of 10, 100
           and 800 m along the reference, without alignment: translation in
           percent, rotation in degrees per 100 m (Geiger et al., KITTI, CVPR
           2012). The mean over 100 m is the drift of hqslam-lab table --seeds.
  slips    places where the motion over ten scans is wrong by more than 0.3 m or
           0.3 degrees; consecutive scans are one slip
  MAE      mean |range - true range|, metres, over all pixels (no return counts
           as 0 m) and over those where both have a return
  Chamfer  mean squared distance to the nearest point, estimate to reference
           plus reference to estimate, m^2
  IoU, F1  of the voxels of 0.1 m that hold a point: both / either; harmonic
           mean of precision (both / estimate) and recall (both / reference)
  outlier points  share of the estimate's points farther than 0.5 m from the
           nearest true one
MAE over all pixels, Chamfer, IoU and F1 are those of TULIP's evaluation code (Yang et al.,
CVPR 2024), but MAE is in metres, not in units of the sensor's range, and pixels without a
return give no points, where TULIP puts them at the sensor. For two stacks the 3-D errors are
means over the images and need --sensor.)";

enum class Kind { kTrajectory, kCloud, kStack };

Kind kind_of(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".npy") return Kind::kStack;
  return std::ranges::count(kBinaryPoints, ending) > 0 ? Kind::kCloud : Kind::kTrajectory;
}

/// The kind of both files. Throws Error where they differ.
Kind kind_of(const EvaluateOptions& options) {
  const Kind kind = kind_of(options.estimate);
  if (kind == kind_of(options.reference)) return kind;
  throw Error(
      "{} and {}: expected two files of one kind; give two trajectories (TUM or KITTI), two clouds "
      "(.pcd, .ply or .bin) or two .npy stacks",
      options.estimate, options.reference);
}

void declare(CLI::App& app, EvaluateOptions& options) {
  const OptionRules read = {.required = true, .given = Given::kFile};
  add_command(app, "evaluate",
              "Compute errors of a trajectory, a point cloud or a stack of range images",
              kDefinitions)
      .option("ESTIMATE", &options.estimate,
              "Trajectory (TUM or KITTI), cloud (.pcd, .ply, .bin) or .npy stack of range images",
              read)
      .option("REFERENCE", &options.reference, "Reference: the same kind of file", read)
      .option("--align", &options.alignment, "Alignment of a trajectory before its APE is computed",
              {.shows_default = true, .one_of = {"se3", "first", "none"}})
      .option("--sensor", &options.sensor,
              "Sensor of two .npy stacks (name or .json file): adds the errors in 3-D");
}

int run(const EvaluateOptions& options) {
  const Kind kind = kind_of(options);
  if (kind == Kind::kStack) return evaluate_stacks(options);
  if (!options.sensor.empty()) {
    throw Error("--sensor {}: expected two .npy stacks, found {}; leave --sensor out",
                options.sensor, options.estimate);
  }
  if (kind == Kind::kCloud) return evaluate_clouds(options);
  return evaluate_trajectories(options);
}

}  // namespace

void add_evaluate(CLI::App& app, Chosen& chosen) { add_subcommand<EvaluateOptions>(app, chosen); }

}  // namespace hqslam::tools
