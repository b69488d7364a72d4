#include "validation.h"

#include "small_network.h"

namespace hqslam::nn {
namespace {

/// Says the same image and confidence of every scan.
class FixedNetwork final : public Network {
 public:
  explicit FixedNetwork(UpsampledImage upsampled) : upsampled_(std::move(upsampled)) {}
  std::int64_t multiply_adds() const override { return 0; }
  void set_parameters(std::span<const float>) override {}
  const UpsampledImage& upsample(const Observation&, float) override { return upsampled_; }
  Trace trace(const Observation&) override { return {}; }

 private:
  UpsampledImage upsampled_;
};

/// Walls 10 m away.
RangeImage walls() { return flat_image(16, 64, 10.0F); }

/// The same; the first 16 columns of the row above the second measured one have no return.
RangeImage truth() {
  RangeImage image = walls();
  for (int column = 0; column < 16; ++column) image.at(6, column) = 0.0F;
  // Linear interpolation misses what is between two rows without returns.
  for (const int row : {7, 11}) {
    for (int column = 40; column < 44; ++column) image.at(row, column) = 0.0F;
  }
  return image;
}

}  // namespace

TEST_CASE("validation empties the least sure pixels until as much is missing as linearly") {
  UpsampledImage upsampled{truth(), std::vector<float>(16 * 64, 0.9F)};
  for (int column = 0; column < 16; ++column) {
    upsampled.image.at(6, column) = 30.0F;  // invented, at a small confidence
    upsampled.confidence[upsampled.image.index(6, column)] = 0.105F;
  }
  // True returns at a small confidence: as many as linear interpolation misses.
  for (int row = 8; row < 11; ++row) {
    for (int column = 40; column < 44; ++column) {
      upsampled.confidence[upsampled.image.index(row, column)] = 0.205F;
    }
  }
  FixedNetwork network(upsampled);
  const Validation validation = validation_of({validated_scan(network, small_du_or(), {truth()})});
  // Of 12 x 64 computed pixels 16 have no true return; 12 + 2 x 8 are beside empty measured rows.
  CHECK(validation.linear.missing_share > 0.0);
  CHECK(validation.network.missing_share == doctest::Approx(12.0 / (12 * 64 - 16)));
  CHECK(validation.network.missing_share <= validation.linear.missing_share);
  CHECK(validation.network.wrong_share == 0.0);
  CHECK(validation.network.mae_valid_m == 0.0);
  CHECK(validation.network.mae_all_m == doctest::Approx(12 * 10.0 / (16 * 64)));
  CHECK(validation.least_confidence > 0.205);
}

TEST_CASE("linear interpolation's figures are over the pixels of all scans, as the network's are") {
  RangeImage nearly_empty(16, 64);  // ten returns between two measured rows without any
  for (int column = 0; column < 10; ++column) nearly_empty.at(5, column) = 10.0F;
  FixedNetwork network({walls(), {}});
  const NetworkDescription description = small_du_or();
  const ImageFigures linear = validation_of({validated_scan(network, description, {walls()}),
                                             validated_scan(network, description, {nearly_empty})})
                                  .linear;
  CHECK(linear.missing_share == doctest::Approx(10.0 / (12 * 64 + 10)));
  CHECK(linear.mae_all_m == doctest::Approx(10 * 10.0 / (2 * 16 * 64)));
  CHECK(linear.mae_valid_m == doctest::Approx(0.0));
  CHECK(linear.wrong_share == 0.0);
}

TEST_CASE("an image without confidence is taken as it is") {
  UpsampledImage upsampled{truth(), {}};
  upsampled.image.at(1, 5) = 10.4F;
  upsampled.image.at(1, 6) = 12.0F;
  upsampled.image.at(6, 3) = 7.0F;  // where truth has nothing
  upsampled.image.at(2, 9) = 0.0F;
  FixedNetwork network(upsampled);
  const Validation validation = validation_of({validated_scan(network, small_du_or(), {truth()})});
  CHECK(validation.network.wrong_share == doctest::Approx(2.0 / (12 * 64 - 16)));
  CHECK(validation.network.missing_share == doctest::Approx(1.0 / (12 * 64 - 16)));
  CHECK(validation.network.mae_all_m == doctest::Approx((0.4 + 2.0 + 7.0 + 10.0) / (16 * 64)));
}

TEST_CASE("the exponent of the confidence makes it the share that is right") {
  // At confidence 0.5 a share of 0.25 is right, at 0.25 a share of 0.0625: squares.
  UpsampledImage upsampled{truth(), std::vector<float>(16 * 64)};
  int number = 0;
  for (std::size_t i = 0; i < upsampled.confidence.size(); ++i) {
    const bool often = i / 64 % 2 == 0;
    upsampled.confidence[i] = often ? 0.5F : 0.25F;
    upsampled.image.range_m[i] = (number++ % 16 < (often ? 4 : 1)) ? 10.0F : 20.0F;
  }
  FixedNetwork network(upsampled);
  const Validation validation = validation_of({validated_scan(network, small_du_or(), {walls()})});
  CHECK(validation.confidence_exponent == doctest::Approx(2.0).epsilon(0.02));
}

}  // namespace hqslam::nn
