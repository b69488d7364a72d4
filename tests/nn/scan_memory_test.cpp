#include "hqslam/nn/scan_memory.h"

#include <omp.h>

#include "hqslam/core/projection.h"
#include "made_images.h"
#include "random_values.h"

namespace hqslam::nn {
namespace {

const SensorModel kMemorySensor = [] {
  SensorModel sensor = preset_with("os1-64", 256);
  sensor.measured_rows = RowSelection{3, 4};
  return sensor;
}();

/// From a place within a hall of 40 x 30 x 8 m to its wall, floor or roof; and to a pillar, 0.6 m
/// thick, around (6, 2), unless it has gone.
float range_to_hall_m(const Eigen::Vector3d& from_m, const Eigen::Vector3d& along, bool pillar) {
  double nearest_m = HUGE_VAL;
  const Eigen::Vector3d low(-20.0, -15.0, -2.0);
  const Eigen::Vector3d high(20.0, 15.0, 6.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double wall = along[axis] > 0.0 ? high[axis] : low[axis];
    if (along[axis] != 0.0) {
      nearest_m = std::min(nearest_m, (wall - from_m[axis]) / along[axis]);
    }
  }
  const Eigen::Vector2d to_axis = Eigen::Vector2d(6.0, 2.0) - from_m.head<2>();
  const Eigen::Vector2d level = along.head<2>();
  const double b = to_axis.dot(level);
  const double d = b * b - level.squaredNorm() * (to_axis.squaredNorm() - 0.3 * 0.3);
  if (pillar && d > 0.0 && b > 0.0) {
    nearest_m = std::min(nearest_m, (b - std::sqrt(d)) / level.squaredNorm());
  }
  return static_cast<float>(nearest_m);
}

/// The sensor's pose at each column of a scan, which begins at a column: it moves by a metre and
/// turns by a tenth of a radian a scan.
ColumnPoses poses_at(double scan, const Eigen::Vector3d& offset_m, int first_column = 0) {
  ColumnPoses poses;
  for (int column = 0; column < 256; ++column) {
    const int turned = (column - first_column + 256) % 256;
    const double t = scan + (turned + 0.5) / 256;
    poses.push_back(pose_from_xyz_rpy(offset_m + Eigen::Vector3d(-8.0 + t, 0.3 * t, 0.01 * t),
                                      0.01 * t, -0.01 * t, 0.1 * t));
  }
  return poses;
}

/// The ranges of all beams, column after column.
RangeImage seen_from(const ColumnPoses& poses, const Eigen::Vector3d& offset_m,
                     bool pillar = true) {
  return made_image(kMemorySensor, [&](int row, int column, const Eigen::Vector3d& along) {
    const Pose& pose = poses[kMemorySensor.firing_column(row, column)];
    return range_to_hall_m(pose.translation() - offset_m, pose.linear() * along, pillar);
  });
}

struct Recalled {
  RangeImage truth;
  RecalledImage recalled;
};

/// After ten scans through the hall, which is at offset_m in the world; each scan begins at
/// another column, `shift` farther on.
Recalled after_ten_scans(const Eigen::Vector3d& offset_m, bool pillar_stays = true, int shift = 0) {
  const RowSelection rows = *kMemorySensor.measured_rows;
  ScanMemory memory(kMemorySensor);
  for (int scan = 0; scan < 10; ++scan) {
    const ColumnPoses poses = poses_at(scan, offset_m, scan * shift % 256);
    const RangeImage measured = select_rows(seen_from(poses, offset_m), rows);
    memory.insert(unproject(measured, select_rows(kMemorySensor, rows), CaptureTime::kRolling),
                  poses, 0.1 * scan);
  }
  const ColumnPoses poses = poses_at(10.0, offset_m, 10 * shift % 256);
  Recalled result{seen_from(poses, offset_m, pillar_stays), {}};
  result.recalled = memory.recall(select_rows(result.truth, rows), poses);
  return result;
}

/// Among the pixels that are recalled.
double share_within_m(const Recalled& r, float limit_m) {
  int recalled = 0;
  int near = 0;
  for (std::size_t i = 0; i < r.truth.range_m.size(); ++i) {
    if (r.recalled.image.range_m[i] <= 0.0F) continue;
    ++recalled;
    near += std::fabs(r.recalled.image.range_m[i] - r.truth.range_m[i]) < limit_m;
  }
  REQUIRE(recalled > 6000);  // of 16384
  return static_cast<double>(near) / recalled;
}

/// A scan with one point, at a range straight ahead in row 31 of 64.
OrganizedCloud one_point(float range_m) {
  RangeImage image(16, 256);
  image.at(7, 128) = range_m;  // row 3 + 7 * 4 = 31
  return unproject(image, select_rows(kMemorySensor, *kMemorySensor.measured_rows),
                   CaptureTime::kMotionCorrected);
}

const ColumnPoses kHere = {Pose::Identity()};
const RangeImage kNoReturns(16, 256);

/// What is recalled in the pixel of such points.
float nearest_m(ScanMemory& memory, const ColumnPoses& poses = kHere,
                std::optional<double> itself_s = {}) {
  return memory.recall(kNoReturns, poses, itself_s).image.at(31, 128);
}

ColumnPoses ahead(double x_m) { return {pose_from_xyz_rpy({x_m, 0.0, 0.0}, 0.0, 0.0, 0.0)}; }

}  // namespace

TEST_CASE("earlier returns are recalled where a later scan would measure, wherever turns begin") {
  for (const int shift : {0, 37}) {
    CAPTURE(shift);
    const Recalled r = after_ten_scans({0.0, 0.0, 0.0}, true, shift);
    CHECK(share_within_m(r, 0.05F) > 0.70);
    CHECK(share_within_m(r, 0.5F) > 0.94);
    for (std::size_t i = 0; i < r.truth.range_m.size(); ++i) {
      REQUIRE((r.recalled.image.range_m[i] > 0.0F) == (r.recalled.weight[i] > 0.0F));
    }
  }
}

TEST_CASE("kilometres from the frame's origin the same is recalled") {
  const Recalled near = after_ten_scans({0.0, 0.0, 0.0});
  const Recalled far = after_ten_scans({54321.0, -9876.0, 321.0});
  int differing = 0;  // a point may fall to the other side of a pixel's edge
  for (std::size_t i = 0; i < near.truth.range_m.size(); ++i) {
    differing += std::fabs(near.recalled.image.range_m[i] - far.recalled.image.range_m[i]) > 0.005F;
  }
  CHECK(differing < 40);
}

TEST_CASE("the same bytes are recalled whatever the number of threads") {
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Recalled one = after_ten_scans({0.0, 0.0, 0.0});
  omp_set_num_threads(3);
  const Recalled three = after_ten_scans({0.0, 0.0, 0.0});
  omp_set_num_threads(before);
  CHECK(one.recalled.image.range_m == three.recalled.image.range_m);
  CHECK(one.recalled.weight == three.recalled.weight);
}

TEST_CASE("a point that a measured beam passes has moved and is forgotten") {
  const auto ghosts = [](const Recalled& r) {  // pixels of the pillar before what is behind it
    int count = 0;
    for (std::size_t i = 0; i < r.truth.range_m.size(); ++i) {
      const float recalled_m = r.recalled.image.range_m[i];
      count += recalled_m > 0.0F && recalled_m < r.truth.range_m[i] - 2.0F;
    }
    return count;
  };
  const Recalled gone = after_ten_scans({0.0, 0.0, 0.0}, false);
  CHECK(ghosts(after_ten_scans({0.0, 0.0, 0.0})) < 20);
  CHECK(ghosts(gone) < 20);  // between the measured rows neither
  for (int row = 3; row < 64; row += 4) {
    for (int column = 0; column < 256; ++column) {
      const float recalled_m = gone.recalled.image.at(row, column);
      CHECK_FALSE((recalled_m > 0.0F && recalled_m < 0.9F * gone.truth.at(row, column) - 0.7F));
    }
  }
}

TEST_CASE("one point is recalled in its pixel, with its range and the weight of one") {
  ScanMemory memory(kMemorySensor);
  CHECK(memory.recall(kNoReturns, kHere).is_empty());
  memory.insert(one_point(10.0F), kHere, 0.0);
  const RecalledImage recalled = memory.recall(kNoReturns, kHere);
  CHECK(recalled.image.at(31, 128) == doctest::Approx(10.0));
  CHECK(recalled.weight[recalled.image.index(31, 128)] == doctest::Approx(4.0).epsilon(0.01));
  CHECK(std::ranges::count_if(recalled.weight, [](float weight) { return weight > 0.0F; }) == 1);
  memory.clear();
  CHECK(memory.recall(kNoReturns, kHere).is_empty());
  // Of two surfaces in a pixel the nearer one is recalled.
  ScanMemory dense(kMemorySensor, {.step_m = 0.0, .step_rad = 0.0});
  dense.insert(one_point(12.0F), kHere, 0.0);
  dense.insert(one_point(10.0F), kHere, 0.1);
  dense.insert(one_point(10.1F), kHere, 0.2);
  CHECK(nearest_m(dense) == doctest::Approx(10.05).epsilon(1e-3));
}

TEST_CASE("scans are forgotten by number, path and time; a sensor that stands keeps its last one") {
  ScanMemory few(kMemorySensor, {.scans = 2});
  ScanMemory near(kMemorySensor, {.path_m = 3.0});
  ScanMemory young(kMemorySensor, {.time_s = 0.25});
  ScanMemory standing(kMemorySensor);
  for (int scan = 0; scan < 4; ++scan) {
    // Each scan's point at another place: 20, 22, 24, 26 m from the beginning, in one pixel.
    for (ScanMemory* memory : {&few, &near, &young}) {
      memory->insert(one_point(20.0F + static_cast<float>(scan)), ahead(scan), 0.1 * scan);
    }
    standing.insert(one_point(20.0F + 2.0F * static_cast<float>(scan)), kHere, 0.1 * scan);
  }
  CHECK(nearest_m(few) == doctest::Approx(24.0).epsilon(1e-3));
  CHECK(nearest_m(near) == doctest::Approx(20.0).epsilon(1e-3));
  near.insert(one_point(24.0F), ahead(4.0), 0.4);
  CHECK(nearest_m(near) == doctest::Approx(22.0).epsilon(1e-3));
  CHECK(nearest_m(young) == doctest::Approx(22.0).epsilon(1e-3));
  CHECK(nearest_m(standing) == doctest::Approx(26.0).epsilon(1e-3));
}

TEST_CASE("a scan recalls later scans that are kept too, but not itself") {
  ScanMemory memory(kMemorySensor, kLookAheadMemory);
  for (int scan = 0; scan < 3; ++scan) {  // a metre nearer each, to what is at 20, 18 and 22 m
    const float at_m = std::array{20.0F, 18.0F, 22.0F}[scan];
    memory.insert(one_point(at_m - static_cast<float>(scan)), ahead(scan), 0.1 * scan);
  }
  CHECK(nearest_m(memory, ahead(0), 0.0) == doctest::Approx(18.0).epsilon(1e-3));
  CHECK(nearest_m(memory, ahead(1), 0.1) == doctest::Approx(19.0).epsilon(1e-3));
  CHECK(nearest_m(memory, ahead(1)) == doctest::Approx(17.0).epsilon(1e-3));
}

TEST_CASE("the scans of a slow sensor are kept step by step") {
  ScanMemory memory(kMemorySensor);
  for (int scan = 0; scan < 40; ++scan) {  // 0.04 m a scan; a step are 0.05 m
    memory.insert(one_point(20.0F - 0.04F * static_cast<float>(scan)), ahead(0.04 * scan),
                  0.1 * scan);
  }
  const RecalledImage recalled = memory.recall(kNoReturns, kHere);
  // One point through the centre of its pixel is worth 4.
  CHECK(recalled.weight[recalled.image.index(31, 128)] > 4.0F * 15.0F);
}

TEST_CASE("what does not fit a memory is refused in one line") {
  SensorModel sensor = kMemorySensor;
  ScanMemory memory(sensor);
  const auto refuses = [](const auto& call, const char* what) { CHECK(refused_with(call, what)); };
  refuses([&] { memory.recall(RangeImage(64, 256), kHere); }, "64 x 256");
  refuses([&] { memory.recall(RangeImage(16, 256), ColumnPoses(7)); }, "7 poses");
  refuses([&] { memory.insert(OrganizedCloud(16, 128), kHere, 0.0); }, "16 x 128");
  refuses([&] { ScanMemory(kMemorySensor, {.scans = 0}); }, "scans");
  refuses([&] { ScanMemory(kMemorySensor, {.time_s = -1.0}); }, "time_s");
  sensor.measured_rows.reset();
  refuses([&] { ScanMemory{sensor}; }, "64 rows without measured_rows");
}

}  // namespace hqslam::nn
