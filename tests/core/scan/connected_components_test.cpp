#include "hqslam/core/connected_components.h"

#include "made_images.h"

namespace {

/// The slow, textbook form: union-find over all pairs of neighbours with atan2.
std::vector<int> union_find_labels(const RangeImage& image, const SensorModel& sensor,
                                   double min_angle_rad,
                                   const std::vector<std::uint8_t>& excluded) {
  std::vector<int> parent(image.range_m.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  const auto takes_part = [&](std::size_t i) {
    return image.range_m[i] > 0.0F && (excluded.empty() || excluded[i] == 0);
  };
  const auto join = [&](std::size_t i, std::size_t j, double alpha_rad) {
    if (!takes_part(i) || !takes_part(j)) return;
    const double far_m = std::max(image.range_m[i], image.range_m[j]);
    const double near_m = std::min(image.range_m[i], image.range_m[j]);
    const double beta_rad =
        std::atan2(near_m * std::sin(alpha_rad), far_m - near_m * std::cos(alpha_rad));
    if (beta_rad > min_angle_rad) {
      const int a = root(static_cast<int>(i));
      const int b = root(static_cast<int>(j));
      parent[std::max(a, b)] = std::min(a, b);
    }
  };
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      join(image.index(row, column), image.index(row, (column + 1) % image.columns),
           sensor.column_step_rad());
      if (row + 1 < image.rows) {
        join(image.index(row, column), image.index(row + 1, column),
             sensor.beam_elevation_rad[row] - sensor.beam_elevation_rad[row + 1]);
      }
    }
  }
  std::map<int, int> number;
  std::vector<int> labels(image.range_m.size(), ConnectedComponents::kNoComponent);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!takes_part(i)) continue;
    const auto found = number.emplace(root(static_cast<int>(i)), static_cast<int>(number.size()));
    labels[i] = found.first->second;
  }
  return labels;
}

ConnectedComponents components_of(const RangeImage& image, const SensorModel& sensor,
                                  double min_angle_rad) {
  ComponentLabeler labeler(sensor, min_angle_rad);
  return labeler.label(image);
}

}  // namespace

TEST_CASE("a near column splits the scan in two, because the scan is a circle") {
  const SensorModel sensor = degrees_apart(5, 360);
  RangeImage image = flat_image(5, 360, 10.0F);
  for (int row = 0; row < 5; ++row) image.at(row, 180) = 5.0F;
  CHECK(components_of(image, sensor, 20 * kDegree_rad).components.size() == 2);
}

TEST_CASE("labels equal those of a slow union-find on random images, with and without a mask") {
  std::mt19937 generator(11);
  for (int trial = 0; trial < 30; ++trial) {
    const SensorModel sensor = degrees_apart(3 + trial % 7, 16 + 9 * (trial % 5));
    RangeImage image(sensor.rows(), sensor.columns);
    for (float& range_m : image.range_m) {
      const auto value = generator() % 100;
      range_m = value < 10 ? 0.0F : 10.0F + 0.01F * static_cast<float>(value * (1 + trial % 4));
    }
    std::vector<std::uint8_t> excluded;
    if (trial % 2 == 1) {
      for (std::size_t i = 0; i < image.range_m.size(); ++i)
        excluded.push_back(generator() % 5 == 0);
    }
    ComponentLabeler labeler(sensor, 30 * kDegree_rad);
    const auto& result = labeler.label(image, excluded);
    REQUIRE(result.label == union_find_labels(image, sensor, 30 * kDegree_rad, excluded));
    std::vector<Component> counted(result.components.size(), {0, 1000, -1});
    for (std::size_t i = 0; i < image.range_m.size(); ++i) {
      if (result.label[i] == ConnectedComponents::kNoComponent) continue;
      Component& component = counted[result.label[i]];
      const int row = static_cast<int>(i) / image.columns;
      component = {component.pixels + 1, std::min<int>(component.first_row, row),
                   std::max<int>(component.last_row, row)};
    }
    for (std::size_t i = 0; i < counted.size(); ++i) {
      CHECK(counted[i].pixels == result.components[i].pixels);
      CHECK(counted[i].first_row == result.components[i].first_row);
      CHECK(counted[i].last_row == result.components[i].last_row);
    }
  }
}

TEST_CASE("more than 65,536 components are distinguished") {
  const RangeImage image = made_image(
      64, 4096, [](int row, int column) { return (row + column) % 2 == 0 ? 5.0 : 50.0; });
  const auto result = components_of(image, degrees_apart(64, 4096), 10 * kDegree_rad);
  CHECK(result.components.size() == 64 * 4096);
  CHECK(std::set(result.label.begin(), result.label.end()).size() == 64 * 4096);
}

TEST_CASE("a second image is not affected by the first") {
  const RangeImage full = flat_image(4, 32, 3.0F);
  ComponentLabeler labeler(degrees_apart(4, 32), 10 * kDegree_rad);
  labeler.label(full);
  CHECK(labeler.label(RangeImage(4, 32)).components.empty());
  CHECK(labeler.label(full).components.size() == 1);
}

TEST_CASE("wrong shapes and angles are refused") {
  const SensorModel sensor = degrees_apart(4, 32);
  CHECK_THROWS_AS(ComponentLabeler(sensor, 0.0), Error);
  CHECK_THROWS_AS(ComponentLabeler(sensor, 2.0), Error);
  ComponentLabeler labeler(sensor, 10 * kDegree_rad);
  CHECK_THROWS_AS(labeler.label(RangeImage(4, 33)), Error);
  CHECK_THROWS_AS(labeler.label(RangeImage(4, 32), std::vector<std::uint8_t>(3)), Error);
}
