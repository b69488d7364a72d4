#include "hqslam/nn/training/augmentation.h"

#include "small_network.h"

namespace hqslam::nn {
namespace {

constexpr RowSelection kMeasured{3, 4};

const Augmentation kNothing{
    .crop_columns = 0, .mirror = false, .smallest_scale = 1.0F, .largest_scale = 1.0F};

/// Ranges that number their pixels; far from the sensor's limits.
RangeImage numbered() {
  return made_image(16, 64, [](int row, int i) { return 10.0 + 0.0625 * (64 * row + i); });
}

TrainingSample sample(const Augmentation& augmentation, std::uint64_t seed) {
  return augmented_sample({numbered()}, small_sensor(), kMeasured, augmentation, seed);
}

int column_of(float range_m) { return static_cast<int>((range_m - 10.0F) * 16.0F) % 64; }

}  // namespace

TEST_CASE("a turned scan is the same scan from another column on, over all columns") {
  std::set<int> turns;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    const RangeImage truth = sample(kNothing, seed).truth;
    const int turn = column_of(truth.at(0, 0));
    turns.insert(turn);
    for (int row : {0, 7, 15}) {
      for (int column = 0; column < 64; ++column) {
        REQUIRE(truth.at(row, column) == numbered().at(row, (turn + column) % 64));
      }
    }
  }
  CHECK(turns.size() == 64);
}

TEST_CASE("half of the scans are mirrored") {
  Augmentation mirror = kNothing;
  mirror.mirror = true;
  int mirrored = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const RangeImage truth = sample(mirror, seed).truth;
    const int step = (column_of(truth.at(0, 1)) - column_of(truth.at(0, 0)) + 64) % 64;
    REQUIRE((step == 1 || step == 63));
    mirrored += step == 63;
    for (int column = 1; column < 64; ++column) {
      REQUIRE(column_of(truth.at(4, column)) == (column_of(truth.at(4, column - 1)) + step) % 64);
    }
  }
  CHECK(mirrored > 150);
  CHECK(mirrored < 250);
}

TEST_CASE("a cut-out has the columns that were asked for, next to each other") {
  Augmentation crop = kNothing;
  crop.crop_columns = 24;
  const TrainingSample s = sample(crop, 3);
  CHECK(s.truth.rows == 16);
  CHECK(s.truth.columns == 24);
  CHECK(s.measured.rows == 4);
  CHECK(s.measured.columns == 24);
  for (int column = 1; column < 24; ++column) {
    CHECK(column_of(s.truth.at(2, column)) == (column_of(s.truth.at(2, column - 1)) + 1) % 64);
  }
}

TEST_CASE("a mirrored cut-out is the same one, from its other end") {
  Augmentation crop = kNothing;
  crop.crop_columns = 24;
  Augmentation mirror = crop;
  mirror.mirror = true;
  int mirrored = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RangeImage usual = sample(crop, seed).truth;
    const RangeImage either = sample(mirror, seed).truth;
    if (either.range_m == usual.range_m) continue;
    ++mirrored;
    for (int column = 0; column < 24; ++column) {
      REQUIRE(either.at(5, column) == usual.at(5, 23 - column));
    }
  }
  CHECK(mirrored > 3);
}

TEST_CASE("all ranges are multiplied by one number between the two scales, measured ones alike") {
  Augmentation scaled = kNothing;
  scaled.smallest_scale = 0.5F;
  scaled.largest_scale = 1.5F;
  double smallest = 9.0;
  double largest = 0.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto [measured, truth, recalled] = sample(scaled, seed);
    CHECK(measured.range_m == select_rows(truth, kMeasured).range_m);
    const RangeImage plain = sample(kNothing, seed).truth;
    const double scale = truth.at(0, 0) / plain.at(0, 0);
    smallest = std::min(smallest, scale);
    largest = std::max(largest, scale);
    for (int i = 0; i < 16 * 64; ++i) {
      const double expected = plain.range_m[i] * scale;
      if (expected < 119.9) REQUIRE(truth.range_m[i] == doctest::Approx(expected).epsilon(1e-5));
    }
  }
  CHECK(smallest >= 0.5);
  CHECK(smallest < 0.55);
  CHECK(largest <= 1.5);
  CHECK(largest > 1.45);
}

TEST_CASE("ranges that leave the sensor's limits are lost, in the truth and in what is measured") {
  SensorModel sensor = small_sensor();
  sensor.min_range_m = 20.0;
  sensor.max_range_m = 50.0;
  Augmentation all{.smallest_scale = 0.8F,
                   .largest_scale = 1.2F,
                   .range_noise_m = 2.0F,
                   .largest_dropout_share = 0.1F};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TrainingSample s = augmented_sample({numbered()}, sensor, kMeasured, all, seed);
    int returns = 0;
    for (const RangeImage* image : {&s.truth, &s.measured}) {
      for (const float range_m : image->range_m) {
        returns += range_m > 0.0F;
        if (range_m != 0.0F) REQUIRE((range_m >= 20.0F && range_m <= 50.0F));
      }
    }
    CHECK(returns > 100);
  }
}

TEST_CASE("pixels without a return stay without, whatever the noise") {
  RangeImage half = numbered();
  for (std::size_t i = 0; i < half.range_m.size(); i += 2) half.range_m[i] = 0.0F;
  const Augmentation noisy{.mirror = false, .range_noise_m = 1.0F};
  const TrainingSample s = augmented_sample({half}, small_sensor(), kMeasured, noisy, 4);
  const std::vector<float> truth_m = select_rows(s.truth, kMeasured).range_m;
  for (std::size_t i = 0; i < truth_m.size(); ++i) {
    REQUIRE((s.measured.range_m[i] > 0.0F) == (truth_m[i] > 0.0F));
  }
}

TEST_CASE("noise has the standard deviation that was asked for and leaves the truth alone") {
  Augmentation noisy = kNothing;
  noisy.range_noise_m = 0.5F;
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TrainingSample s = sample(noisy, seed);
    CHECK(s.truth.range_m == sample(kNothing, seed).truth.range_m);
    const std::vector<float> truth_m = select_rows(s.truth, kMeasured).range_m;
    for (std::size_t i = 0; i < truth_m.size(); ++i, ++count) {
      const double noise = s.measured.range_m[i] - truth_m[i];
      sum += noise;
      squares += noise * noise;
    }
  }
  CHECK(std::fabs(sum / count) < 0.03);
  CHECK(std::sqrt(squares / count) == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("between none and the largest share of the measured returns is lost, of the truth none") {
  Augmentation lossy = kNothing;
  lossy.largest_dropout_share = 0.4F;
  double mean = 0.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const TrainingSample s = sample(lossy, seed);
    const auto lost = std::ranges::count(s.measured.range_m, 0.0F);
    CHECK(std::ranges::count(s.truth.range_m, 0.0F) == 0);
    const double share = static_cast<double>(lost) / (4 * 64);
    CHECK(share < 0.4 + 0.1);
    mean += share / 200;
  }
  CHECK(mean == doctest::Approx(0.2).epsilon(0.15));
}

}  // namespace hqslam::nn
