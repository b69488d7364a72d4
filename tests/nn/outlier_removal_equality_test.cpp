#include "outlier_masks.h"

// The filter against two independent searches for components.
namespace hqslam::nn {
namespace {

/// By a flood fill of a cut-out that is closed to a circle.
Mask from_flood_fill(const RangeImage& image, const SensorModel& sensor, RowSelection rows) {
  const OutlierRemovalOptions options;
  const auto tan = static_cast<float>(std::tan(options.min_angle_rad));
  const std::vector<double>& elevation = sensor.beam_elevation_rad;
  Mask visited(image.range_m.size(), 0);
  Mask rejected(image.range_m.size(), 0);
  for (std::size_t first = 0; first < visited.size(); ++first) {
    if (visited[first] != 0 || image.range_m[first] <= 0.0F) continue;
    std::vector<std::size_t> pixels{first};
    visited[first] = 1;
    for (std::size_t next = 0; next < pixels.size(); ++next) {
      const int r = static_cast<int>(pixels[next]) / image.columns;
      const int c = static_cast<int>(pixels[next]) % image.columns;
      const auto visit = [&](int to_row, int to_column, double alpha_rad) {
        const std::size_t to = image.index(to_row, to_column);
        if (visited[to] != 0 || image.at(to_row, to_column) == 0.0F) return;
        if (!ComponentLabeler::connected(image.at(r, c), image.range_m[to],
                                         static_cast<float>(std::sin(alpha_rad)),
                                         static_cast<float>(std::cos(alpha_rad)), tan)) {
          return;
        }
        visited[to] = 1;
        pixels.push_back(to);
      };
      if (r > 0) visit(r - 1, c, elevation[r - 1] - elevation[r]);
      if (r + 1 < image.rows) visit(r + 1, c, elevation[r] - elevation[r + 1]);
      visit(r, (c + 1) % image.columns, sensor.column_step_rad());
      visit(r, (c + image.columns - 1) % image.columns, sensor.column_step_rad());
    }
    if (static_cast<int>(pixels.size()) >= options.min_pixels) continue;
    for (const std::size_t pixel : pixels) {
      rejected[pixel] = !is_measured(static_cast<int>(pixel) / image.columns, rows);
    }
  }
  return rejected;
}

struct Counts {
  int wrong = 0;
  std::int64_t rejected = 0;
  std::int64_t kept = 0;
};

void check(const Counts& counts, std::int64_t at_least) {
  CHECK(counts.wrong == 0);
  CHECK(counts.rejected > at_least);
  CHECK(counts.kept > at_least);
}

void compare(Counts& counts, const Mask& expected, const Mask& actual, const RangeImage& image) {
  counts.wrong += expected != actual;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    counts.rejected += expected[i];
    counts.kept += expected[i] == 0 && image.range_m[i] > 0.0F;
  }
}

}  // namespace

TEST_CASE("whole scans give the mask of core's breadth-first search, with any number of threads") {
  std::mt19937 generator(20);
  int threads = 1;
  Counts counts;
  for (const std::string name : {"os1-64", "hdl-64e", "vlp-16"}) {
    SensorModel sensor = sensor_preset(name);
    for (const int columns : {1024, 360, 37}) {
      sensor.columns = columns;
      const RowSelection rows{sensor.rows() == 64 ? 3 : 0, 4};
      OutlierRemoval removal(sensor, rows, {}, columns);
      for_each_kind(sensor.rows(), columns, generator, [&](const RangeImage& image) {
        compare(counts, from_component_labeler(image, sensor, rows, {}),
                found(removal, image, threads), image);
        threads = threads % 3 + 1;
      });
    }
  }
  check(counts, 10000);
}

TEST_CASE("the same mask for every size of component and every angle") {
  std::mt19937 generator(21);
  Counts counts;
  for (const int min_pixels : {0, 1, 2, 3, 5, 20, 64, 65, 66, 129, 200, 500, 100000}) {
    for (const double angle_deg : {1.0, 10.0, 60.0, 89.0}) {
      const SensorModel sensor = degrees_apart(9, 200);
      const OutlierRemovalOptions options{angle_deg * kDegree_rad, min_pixels};
      OutlierRemoval removal(sensor, kNothingMeasured, options, 200);
      for_each_kind(9, 200, generator, [&](const RangeImage& image) {
        compare(counts, from_component_labeler(image, sensor, kNothingMeasured, options),
                found(removal, image), image);
      });
    }
  }
  check(counts, 10000);
}

TEST_CASE("cut-outs give the same mask as a flood fill that closes them to a circle") {
  std::mt19937 generator(22);
  Counts counts;
  const SensorModel sensor = sensor_preset("hdl-64e");
  for (const int columns : {512, 65, 64, 63, 37, 3, 2, 1}) {
    OutlierRemoval removal(sensor, {3, 4}, {}, columns);
    for_each_kind(sensor.rows(), columns, generator, [&](const RangeImage& image) {
      compare(counts, from_flood_fill(image, sensor, {3, 4}), found(removal, image), image);
    });
  }
  check(counts, 1000);
}

TEST_CASE("winding components, which no sweep over the rows fills at once, are whole") {
  // A path of single pixels that goes up and down and ends in a run of `tail` pixels.
  for (const int tail : {1, 30}) {
    for (const int folds : {1, 4, 20}) {
      const SensorModel sensor = degrees_apart(12, 360);
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

}  // namespace hqslam::nn
