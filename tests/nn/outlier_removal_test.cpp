#include "hqslam/nn/hqs/outlier_removal.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/error.h"

using hqslam::RangeImage;
using hqslam::RowSelection;
using hqslam::SensorModel;
using hqslam::nn::OutlierRemoval;
using hqslam::nn::OutlierRemovalOptions;

namespace {

using Mask = std::vector<std::uint8_t>;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr RowSelection kNothingMeasured{1000, 1};

/// `rows` beams and `columns` columns, neighbouring beams one degree apart.
SensorModel small_sensor(int rows, int columns) {
  SensorModel sensor;
  sensor.columns = columns;
  for (int row = 0; row < rows; ++row) sensor.beam_elevation_rad.push_back(-row * kDegree);
  sensor.beam_azimuth_offset_rad.assign(rows, 0.0);
  return sensor;
}

double uniform(std::mt19937& generator) { return static_cast<double>(generator()) / 4294967296.0; }

Mask found(OutlierRemoval& removal, const RangeImage& image, int threads = 1) {
  Mask rejected(image.range_m.size(), 7);
  removal.find(image.range_m.data(), rejected.data(), threads);
  return rejected;
}

bool is_measured(int row, RowSelection rows) {
  return row >= rows.offset && (row - rows.offset) % rows.stride == 0;
}

/// From the breadth-first search of core, which knows whole scans only.
Mask from_component_labeler(const RangeImage& image, const SensorModel& sensor, RowSelection rows,
                            const OutlierRemovalOptions& options) {
  hqslam::ComponentLabeler labeler(sensor, {.min_angle_rad = options.min_angle_rad});
  const hqslam::ConnectedComponents& result = labeler.label(image);
  Mask rejected(image.range_m.size(), 0);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const std::int32_t label = result.label[image.index(row, column)];
      rejected[image.index(row, column)] = label >= 0 && !is_measured(row, rows) &&
                                           result.components[label].pixels < options.min_pixels;
    }
  }
  return rejected;
}

/// The pixels of the component around a pixel of a cut-out closed to a circle, by flood fill.
class FloodFill {
 public:
  FloodFill(const RangeImage& image, const SensorModel& sensor, double min_angle_rad)
      : image_(image), sensor_(sensor), tan_(static_cast<float>(std::tan(min_angle_rad))) {}

  std::vector<std::size_t> component(int row, int column, Mask& visited) const {
    std::vector<std::size_t> pixels{image_.index(row, column)};
    visited[pixels[0]] = 1;
    for (std::size_t next = 0; next < pixels.size(); ++next) {
      const int r = static_cast<int>(pixels[next]) / image_.columns;
      const int c = static_cast<int>(pixels[next]) % image_.columns;
      const auto visit = [&](int to_row, int to_column, double alpha_rad) {
        const std::size_t to = image_.index(to_row, to_column);
        if (visited[to] != 0 || !image_.has_return(to_row, to_column)) return;
        if (!hqslam::ComponentLabeler::connected(image_.at(r, c), image_.range_m[to],
                                                 static_cast<float>(std::sin(alpha_rad)),
                                                 static_cast<float>(std::cos(alpha_rad)), tan_)) {
          return;
        }
        visited[to] = 1;
        pixels.push_back(to);
      };
      const auto& elevation = sensor_.beam_elevation_rad;
      if (r > 0) visit(r - 1, c, elevation[r - 1] - elevation[r]);
      if (r + 1 < image_.rows) visit(r + 1, c, elevation[r] - elevation[r + 1]);
      visit(r, (c + 1) % image_.columns, sensor_.column_step_rad());
      visit(r, (c + image_.columns - 1) % image_.columns, sensor_.column_step_rad());
    }
    return pixels;
  }

 private:
  const RangeImage& image_;
  const SensorModel& sensor_;
  float tan_;
};

Mask from_flood_fill(const RangeImage& image, const SensorModel& sensor, RowSelection rows,
                     const OutlierRemovalOptions& options) {
  const FloodFill flood(image, sensor, options.min_angle_rad);
  Mask visited(image.range_m.size(), 0);
  Mask rejected(image.range_m.size(), 0);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      if (visited[image.index(row, column)] != 0 || !image.has_return(row, column)) continue;
      const std::vector<std::size_t> pixels = flood.component(row, column, visited);
      if (static_cast<int>(pixels.size()) >= options.min_pixels) continue;
      for (const std::size_t pixel : pixels) {
        rejected[pixel] = !is_measured(static_cast<int>(pixel) / image.columns, rows);
      }
    }
  }
  return rejected;
}

enum class Kind { kEmpty, kFull, kNoise, kSparse, kSurfaces, kPatches, kMesh, kCount };

/// A random image: `share` of the pixels has a return, or of the structure's links holds.
RangeImage random_image(Kind kind, int rows, int columns, std::mt19937& generator) {
  RangeImage image(rows, columns);
  const double share = 0.2 + 0.75 * uniform(generator);
  const double phase = 6.3 * uniform(generator);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double dice = uniform(generator);
      double range_m = 0.0;
      if (kind == Kind::kFull) range_m = 10.0;
      if (kind == Kind::kNoise) range_m = 5.0 + 5.0 * dice;
      if (kind == Kind::kSparse) range_m = dice < 0.1 ? 8.0 : 0.0;
      if (kind == Kind::kSurfaces) {  // waves with steps and with ghosts between them
        const double angle = 2.0 * std::numbers::pi * column / columns;
        range_m = 12.0 + 4.0 * std::sin(3.0 * angle + phase) + (std::cos(9.0 * angle) > 0 ? 6 : 0);
        range_m *= dice > 0.9 ? 0.5 + 5.0 * (dice - 0.9) : 1.0 + 0.002 * dice;
      }
      if (kind == Kind::kPatches) {  // rectangles of all sizes at a few depths
        const int patch = (row / 3 * 7 + column / 5 * 3 + static_cast<int>(phase)) % 6;
        range_m = dice < 0.03 ? 0.0 : 4.0 + 3.0 * patch;
      }
      if (kind == Kind::kMesh) range_m = dice < share ? 10.0 : 0.0;  // percolating
      image.at(row, column) = static_cast<float>(range_m);
    }
  }
  return image;
}

struct Counts {
  int images = 0;
  int wrong = 0;
  std::int64_t rejected = 0;
  std::int64_t kept = 0;
};

void compare(Counts& counts, const Mask& expected, const Mask& actual, const RangeImage& image) {
  ++counts.images;
  counts.wrong += expected != actual;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    counts.rejected += expected[i];
    counts.kept += expected[i] == 0 && image.range_m[i] > 0.0F;
  }
}

/// A row of connected pixels from `first` to `last`, 10 m away.
void draw_run(RangeImage& image, int row, int first, int last) {
  for (int column = first; column <= last; ++column) image.at(row, column) = 10.0F;
}

}  // namespace

TEST_CASE("options that make no sense are refused") {
  const SensorModel sensor = hqslam::sensor_preset("os1-64");
  const RowSelection rows{3, 4};
  CHECK_NOTHROW(OutlierRemoval(sensor, rows, {}, sensor.columns));
  CHECK_NOTHROW(OutlierRemoval(sensor, rows, {}, 1));
  for (const double angle_rad : {0.0, -0.1, 1.5708, std::nan("")}) {
    CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {.min_angle_rad = angle_rad}, 512), hqslam::Error);
  }
  CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {.min_pixels = -1}, 512), hqslam::Error);
  for (const int columns : {0, -5, sensor.columns + 1}) {
    CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {}, columns), hqslam::Error);
  }
  CHECK_THROWS_AS(OutlierRemoval(sensor, {-1, 4}, {}, 512), hqslam::Error);
  CHECK_THROWS_AS(OutlierRemoval(sensor, {3, 0}, {}, 512), hqslam::Error);
}

TEST_CASE("a component of 19 pixels is rejected, one of 20 stays") {
  const SensorModel sensor = small_sensor(8, 360);
  OutlierRemoval removal(sensor, kNothingMeasured, {}, 360);
  RangeImage image(8, 360);
  draw_run(image, 1, 50, 68);    // 19 in a row
  draw_run(image, 1, 100, 119);  // 20 in a row
  draw_run(image, 4, 100, 109);  // 10 + 9
  draw_run(image, 5, 109, 117);
  draw_run(image, 4, 200, 209);  // 10 + 10
  draw_run(image, 5, 209, 218);
  draw_run(image, 4, 250, 269);  // 20 and an arm below of one pixel
  draw_run(image, 5, 260, 260);
  draw_run(image, 6, 300, 300);  // alone
  Mask expected(image.range_m.size(), 0);
  for (int column = 50; column <= 68; ++column) expected[image.index(1, column)] = 1;
  for (int column = 100; column <= 109; ++column) expected[image.index(4, column)] = 1;
  for (int column = 109; column <= 117; ++column) expected[image.index(5, column)] = 1;
  expected[image.index(6, 300)] = 1;
  CHECK(found(removal, image) == expected);
}

TEST_CASE("the last column is a neighbour of the first") {
  const SensorModel sensor = small_sensor(3, 360);
  OutlierRemoval removal(sensor, kNothingMeasured, {}, 360);
  RangeImage image(3, 360);
  draw_run(image, 0, 0, 9);
  draw_run(image, 0, 350, 359);
  draw_run(image, 2, 0, 8);
  draw_run(image, 2, 350, 359);
  Mask expected(image.range_m.size(), 0);
  for (int column = 0; column <= 8; ++column) expected[image.index(2, column)] = 1;
  for (int column = 350; column <= 359; ++column) expected[image.index(2, column)] = 1;
  CHECK(found(removal, image) == expected);
}

TEST_CASE("a step in range parts a component, the same step seen at a wider angle does not") {
  // At 1 degree and 10 degrees of slope, 10 m connects with 10 m + x for
  // 10 sin 1 > tan 10 (10 + x - 10 cos 1), x < 0.988 m; at 0.5 degrees for x < 0.495 m.
  const SensorModel sensor = small_sensor(1, 360);
  OutlierRemoval removal(sensor, kNothingMeasured, {}, 360);
  RangeImage image(1, 360);
  draw_run(image, 0, 100, 109);
  for (int column = 110; column < 120; ++column) image.at(0, column) = 10.98F;
  CHECK(found(removal, image) == Mask(360, 0));
  for (int column = 110; column < 120; ++column) image.at(0, column) = 11.0F;
  Mask expected(360, 0);
  for (int column = 100; column < 120; ++column) expected[column] = 1;
  CHECK(found(removal, image) == expected);
  const SensorModel finer = small_sensor(1, 720);
  OutlierRemoval cut_out(finer, kNothingMeasured, {}, 360);
  for (int column = 110; column < 120; ++column) image.at(0, column) = 10.98F;
  CHECK(found(cut_out, image) == expected);
}

TEST_CASE("a pixel of a measured row is never rejected but counts for its component") {
  const SensorModel sensor = small_sensor(8, 360);
  OutlierRemoval removal(sensor, {3, 4}, {}, 360);
  RangeImage image(8, 360);
  draw_run(image, 3, 10, 19);  // measured; 10 + 10
  draw_run(image, 4, 10, 19);
  draw_run(image, 7, 50, 50);  // measured, alone
  draw_run(image, 6, 90, 90);  // not measured, alone
  Mask expected(image.range_m.size(), 0);
  expected[image.index(6, 90)] = 1;
  CHECK(found(removal, image) == expected);
}

TEST_CASE("whole scans give the same mask as the breadth-first search of core") {
  std::mt19937 generator(20);
  Counts counts;
  for (const std::string name : {"os1-64", "hdl-64e", "vlp-16"}) {
    SensorModel sensor = hqslam::sensor_preset(name);
    for (const int columns : {1024, 360, 37}) {
      sensor.columns = columns;
      const RowSelection rows{sensor.rows() == 64 ? 3 : 0, 4};
      OutlierRemoval removal(sensor, rows, {}, columns);
      for (int kind = 0; kind < static_cast<int>(Kind::kCount); ++kind) {
        const RangeImage image =
            random_image(static_cast<Kind>(kind), sensor.rows(), columns, generator);
        compare(counts, from_component_labeler(image, sensor, rows, {}), found(removal, image),
                image);
      }
    }
  }
  CHECK(counts.wrong == 0);
  CHECK(counts.rejected > 10000);
  CHECK(counts.kept > 10000);
}

TEST_CASE("the same mask for every size of component and every angle") {
  std::mt19937 generator(21);
  Counts counts;
  for (const int min_pixels : {0, 1, 2, 3, 5, 20, 64, 65, 66, 129, 200, 500, 100000}) {
    for (const double angle_deg : {1.0, 10.0, 60.0, 89.0}) {
      const SensorModel sensor = small_sensor(9, 200);
      const OutlierRemovalOptions options{angle_deg * kDegree, min_pixels};
      OutlierRemoval removal(sensor, kNothingMeasured, options, 200);
      for (int kind = 0; kind < static_cast<int>(Kind::kCount); ++kind) {
        const RangeImage image = random_image(static_cast<Kind>(kind), 9, 200, generator);
        compare(counts, from_component_labeler(image, sensor, kNothingMeasured, options),
                found(removal, image), image);
      }
    }
  }
  CHECK(counts.wrong == 0);
  CHECK(counts.rejected > 10000);
  CHECK(counts.kept > 10000);
}

TEST_CASE("cut-outs give the same mask as a flood fill that closes them to a circle") {
  std::mt19937 generator(22);
  Counts counts;
  const SensorModel sensor = hqslam::sensor_preset("hdl-64e");
  for (const int columns : {512, 65, 64, 63, 37, 3, 2, 1}) {
    OutlierRemoval removal(sensor, {3, 4}, {}, columns);
    for (int kind = 0; kind < static_cast<int>(Kind::kCount); ++kind) {
      const RangeImage image =
          random_image(static_cast<Kind>(kind), sensor.rows(), columns, generator);
      compare(counts, from_flood_fill(image, sensor, {3, 4}, {}), found(removal, image), image);
    }
  }
  CHECK(counts.wrong == 0);
  CHECK(counts.rejected > 1000);
  CHECK(counts.kept > 1000);
}

TEST_CASE("winding components, which no sweep over the rows fills at once, are whole") {
  // A path of single pixels that goes up and down and ends in a run of `tail` pixels.
  for (const int tail : {1, 30}) {
    for (const int folds : {1, 4, 20}) {
      const SensorModel sensor = small_sensor(12, 360);
      RangeImage image(12, 360);
      int column = 320;
      for (int fold = 0; fold < folds; ++fold) {
        for (int row = 0; row < 12; ++row) image.at(row, column) = 10.0F;
        draw_run(image, fold % 2 == 0 ? 11 : 0, column, column + 2);
        column = (column + 2) % 360;
        if (column > 350) column = 2;
      }
      image.at(5, 200) = 10.0F;
      draw_run(image, folds % 2 == 0 ? 0 : 11, column, column + tail - 1);
      for (const int min_pixels : {13, 20, 30, 60, 250}) {
        const OutlierRemovalOptions options{.min_pixels = min_pixels};
        OutlierRemoval removal(sensor, kNothingMeasured, options, 360);
        CHECK(found(removal, image) ==
              from_component_labeler(image, sensor, kNothingMeasured, options));
      }
    }
  }
}

TEST_CASE("ranges that are no ranges are no returns") {
  std::mt19937 generator(23);
  const SensorModel sensor = small_sensor(6, 100);
  OutlierRemoval removal(sensor, kNothingMeasured, {}, 100);
  for (const float value : {-0.0F, -3.0F, std::nanf(""), HUGE_VALF, -HUGE_VALF, 1e-42F}) {
    RangeImage image = random_image(Kind::kPatches, 6, 100, generator);
    for (int i = 0; i < 200; ++i) image.range_m[generator() % 600] = value;
    CHECK(found(removal, image) == from_component_labeler(image, sensor, kNothingMeasured, {}));
  }
}

TEST_CASE("negative ranges are no returns at angles at which the formula connects them") {
  std::mt19937 generator(25);
  for (const int columns : {3, 9}) {
    SensorModel sensor = small_sensor(5, columns);
    for (double& elevation_rad : sensor.beam_elevation_rad) elevation_rad *= 30.0;
    for (const int min_pixels : {2, 3, 5, 8}) {
      const OutlierRemovalOptions options{89.0 * kDegree, min_pixels};
      OutlierRemoval removal(sensor, kNothingMeasured, options, columns);
      int wrong = 0;
      for (int i = 0; i < 200; ++i) {
        RangeImage image = random_image(Kind::kMesh, 5, columns, generator);
        for (float& range_m : image.range_m) range_m = range_m > 0.0F ? 1.0F : -10.0F;
        wrong += found(removal, image) !=
                 from_component_labeler(image, sensor, kNothingMeasured, options);
      }
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("components reach over rows that different threads label") {
  const SensorModel sensor = small_sensor(16, 360);
  OutlierRemoval removal(sensor, kNothingMeasured, {}, 360);
  for (int row = 0; row + 1 < 16; ++row) {
    RangeImage image(16, 360);
    draw_run(image, row, 10, 10);  // one pixel above a long run
    draw_run(image, row + 1, 10, 40);
    draw_run(image, row, 100, 130);  // one pixel below a long run
    draw_run(image, row + 1, 110, 110);
    draw_run(image, row, 200, 209);  // 10 + 10
    draw_run(image, row + 1, 209, 218);
    for (const int threads : {1, 2, 4}) {
      CHECK(found(removal, image, threads) == Mask(image.range_m.size(), 0));
    }
  }
}

TEST_CASE("the number of threads and earlier images change nothing") {
  std::mt19937 generator(24);
  const SensorModel sensor = hqslam::sensor_preset("os1-64");
  OutlierRemoval used(sensor, {3, 4}, {}, sensor.columns);
  for (int kind = 0; kind < static_cast<int>(Kind::kCount); ++kind) {
    const RangeImage image =
        random_image(static_cast<Kind>(kind), sensor.rows(), sensor.columns, generator);
    OutlierRemoval fresh(sensor, {3, 4}, {}, sensor.columns);
    const Mask expected = found(fresh, image);
    for (const int threads : {1, 2, 3}) CHECK(found(used, image, threads) == expected);
  }
}

TEST_CASE("a small component stays where a measured range nearby supports it") {
  const SensorModel sensor = small_sensor(8, 64);
  std::vector<float> range_m(8 * 64, 0.0F);
  const auto at = [&](int row, int column) -> float& { return range_m[row * 64 + column]; };
  at(3, 10) = 20.0F;   // measured
  at(1, 11) = 20.15F;  // within 1 % of it, a column beside it
  at(5, 9) = 19.9F;    // below it
  at(5, 10) = 20.3F;   // not within 1 %
  at(5, 12) = 20.0F;   // two columns away
  at(3, 63) = 9.0F;
  at(2, 0) = 9.05F;  // round the circle
  at(7, 40) = 5.0F;  // measured itself
  std::vector<std::uint8_t> rejected(range_m.size());
  OutlierRemovalOptions options;
  options.support_share = 0.01F;
  for (const int threads : {1, 2}) {
    OutlierRemoval(sensor, {3, 4}, options, 64).find(range_m.data(), rejected.data(), threads);
    std::vector<int> rejected_pixels;
    for (int i = 0; i < 8 * 64; ++i) {
      if (rejected[i] != 0) rejected_pixels.push_back(i);
    }
    CHECK(rejected_pixels == std::vector<int>{5 * 64 + 10, 5 * 64 + 12});
  }
  options.support_share = -0.5F;
  CHECK_THROWS_AS(OutlierRemoval(sensor, {3, 4}, options, 64), hqslam::Error);
}
