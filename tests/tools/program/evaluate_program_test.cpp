#include "made_images.h"
#include "points_file.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

ProgramResult evaluate(const std::string& estimate, const std::string& reference,
                       const std::string& options = "") {
  return succeeds("evaluate '{}' '{}' {}", estimate, reference, options);
}

}  // namespace

TEST_CASE("evaluate names the alignment, which alone takes an offset away, and counts a jump") {
  const TemporaryDirectory folder;
  Trajectory truth(300);  // 1 m apart along x
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth[i].stamp_s = 0.1 * static_cast<double>(i);
    truth[i].T_map_sensor.translation().x() = static_cast<double>(i);
  }
  write_tum(truth, folder.file("truth.tum"));
  Trajectory estimate = truth;
  const auto printed = [&](const std::string& options) {
    write_tum(estimate, folder.file("estimate"));
    return evaluate(folder.file("estimate"), folder.file("truth.tum"), options).out;
  };
  for (StampedPose& pose : estimate) pose.T_map_sensor.translation().y() += 2.0;
  for (const auto& [alignment, rmse] :
       {std::pair{"none", "2.0000"}, std::pair{"first", "0.0000"}, std::pair{"se3", "0.0000"}}) {
    CAPTURE(alignment);
    CHECK(holds(printed(std::string("--align ") + alignment),
                fmt::format("{:<26}{:>10}", fmt::format("APE m (align {})", alignment), rmse)));
  }
  for (int i = 150; i < 300; ++i) estimate[i].T_map_sensor.translation().y() += 0.5;
  CHECK(holds(printed(""), fmt::format("{:<26}{:>10}{:>10} per 100 km", "slips", 1, "334.4")));
  for (StampedPose& pose : estimate) pose.T_map_sensor.translation() *= 1000.0;
  write_tum(estimate, folder.file("estimate"));
  CHECK(holds(evaluate(folder.file("estimate"), folder.file("truth.tum"), "").error,
              "the estimate's path is 1000 times as long as the reference's; millimetres?"));
}

TEST_CASE("evaluate names the file whose quaternions begin with qw") {
  const TemporaryDirectory folder;
  Trajectory circle(100);
  std::string w_first;
  for (std::size_t i = 0; i < circle.size(); ++i) {
    const double turn = 0.05 * static_cast<double>(i);
    circle[i] = {2.0 * turn, pose_from_xyz_rpy({10.0 * std::sin(turn), -10.0 * std::cos(turn), 0.0},
                                               0.0, 0.0, turn)};
    w_first += fmt::format("{} {} {} 0 {} 0 0 {}\n", circle[i].stamp_s, 10.0 * std::sin(turn),
                           -10.0 * std::cos(turn), std::cos(turn / 2), std::sin(turn / 2));
  }
  const std::string right = folder.file("right");
  const std::string wrong = folder.file("w_first");
  write_tum(circle, right);
  write_file(wrong, w_first);
  CHECK(evaluate(right, right).error.empty());
  CHECK(holds(evaluate(right, wrong).error, "w_first: its rotations agree only if read as qw"));
  CHECK(holds(evaluate(wrong, right).error, "w_first: its rotations agree only if read as qw"));
}

TEST_CASE("two stacks that differ by 0.5 m in every fourth pixel have the MAE that follows") {
  const TemporaryDirectory folder;
  // Half of the pixels have no return in either; of the others every second one is 0.5 m off.
  RangeImage truth(16, 1024);
  RangeImage image(16, 1024);
  for (std::size_t i = 0; i < truth.range_m.size(); i += 2) {
    truth.range_m[i] = 10.0F;
    image.range_m[i] = i % 4 == 0 ? 10.5F : 10.0F;
  }
  write_stack(folder.file("truth.npy"), {truth});
  write_stack(folder.file("image.npy"), {image});
  CHECK(missing(evaluate(folder.file("image.npy"), folder.file("truth.npy"), "--sensor os1-16").out,
                {"MAE, all pixels       0.1250 m", "MAE, valid pixels     0.2500 m (8192 pixels)",
                 "voxel F1"}) == "");
}

TEST_CASE("two clouds 1 m apart are all outliers with a Chamfer distance of 2 m^2") {
  const TemporaryDirectory folder;
  write_points({{1.0F, 2.0F, 0.0F}, {50.0F, 0.0F, 0.0F}}, folder.file("truth.pcd"));
  Scan cloud;
  cloud.points_m = {{1.0F, 2.0F, 1.0F}, {50.0F, 0.0F, 1.0F}};
  for (const char* name : {"cloud.pcd", "cloud.ply"}) {
    write_cloud(cloud, folder.file(name));
    const ProgramResult result = evaluate(folder.file(name), folder.file("truth.pcd"));
    CHECK(missing(result.out, {"Chamfer distance      2.0000 m^2", "voxel IoU at 0.1 m    0.0000",
                               "outlier points        100.00 %"}) == "");
  }
}

TEST_CASE("files of two kinds, and stacks of different lengths, are refused") {
  const TemporaryDirectory folder;
  write_points({{1.0F, 2.0F, 0.0F}}, folder.file("cloud.pcd"));
  write_stack(folder.file("one.npy"), {RangeImage(16, 64)});
  write_stack(folder.file("two.npy"), {RangeImage(16, 64), RangeImage(16, 64)});
  const auto error_of = [&](const char* estimate, const char* reference) {
    return refused("evaluate '{}' '{}'", folder.file(estimate), folder.file(reference));
  };
  CHECK(holds(error_of("cloud.pcd", "one.npy"), "two files of one kind"));
  CHECK(missing(error_of("one.npy", "two.npy"), {"1 images", "2; give"}) == "");
}

}  // namespace hqslam::test
