#include "ordered_scans.h"

#include "hqslam/core/left_out.h"
#include "made_scans.h"

using namespace hqslam::recordings;

namespace {

struct ReadScans {
  std::vector<double> stamps_s;
  LeftOut left_out;
  std::vector<std::string> warnings;
};

/// Scans of the rooms of these widths, read with these stamps.
ReadScans read(const std::vector<double>& stamps_s, std::vector<float> widths_m = {},
               const std::vector<int>& seen_columns = {}) {
  for (std::size_t i = widths_m.size(); i < stamps_s.size(); ++i) {
    widths_m.push_back(static_cast<float>(i + 1));
  }
  const auto source = ordered(std::make_unique<MadeScans>(stamps_s.size(), [=](std::size_t i) {
    RecordedScan scan;
    scan.stamp_s = stamps_s[i];
    scan.cloud = OrganizedCloud(16, 100);
    scan.cloud.range_m.assign(1600, widths_m[i]);
    if (i < seen_columns.size()) {
      for (int row = 0; row < 16; ++row) {
        std::fill_n(&scan.cloud.range_m[row * 100], 100 - seen_columns[i], 0.0F);
      }
    }
    scan.counts.kept = 1600;
    return scan;
  }));
  ReadScans result;
  while (const auto scan = next_usable(*source, result.left_out)) {
    result.stamps_s.push_back(std::round(1e6 * scan->stamp_s) / 1e6);
  }
  result.warnings = source->warnings();
  return result;
}

using Stamps = std::vector<double>;

}  // namespace

TEST_CASE("a scan that was recorded twice, with its stamp or another, is left out and counted") {
  for (const double second_s : {0.1, 0.15}) {
    const ReadScans result = read({0.1, second_s, 0.2, 0.3}, {5.0F, 5.0F, 6.0F, 7.0F});
    CHECK(result.stamps_s == Stamps{0.1, 0.2, 0.3});
    CHECK(result.left_out.scans == 1);
  }
}

TEST_CASE(
    "a first scan that is the end of a turn is left out, a narrow view or a later gap is not") {
  const std::vector<double> stamps_s = {0.1, 0.2, 0.3, 0.4};
  const ReadScans result = read(stamps_s, {}, {60, 100, 90, 100});
  CHECK(result.stamps_s == Stamps{0.2, 0.3, 0.4});
  CHECK(result.left_out.first.find("returns in 60 columns, the next scans in 90") !=
        std::string::npos);
  for (const std::vector<int>& whole : {std::vector<int>{70, 90, 100, 100},
                                        {50, 50, 50, 50},
                                        {100, 30, 100, 100},
                                        {60, 100, 60, 100}}) {
    CHECK(read(stamps_s, {}, whole).left_out.scans == 0);
  }
}

TEST_CASE("scans that changed places are read in the order of their stamps, which is said") {
  const ReadScans in_order = read({0.1, 0.2, 0.4});
  CHECK(in_order.stamps_s == Stamps{0.1, 0.2, 0.4});
  CHECK(in_order.left_out.scans == 0);
  CHECK(in_order.warnings.empty());
  const ReadScans result = read({0.1, 0.3, 0.2, 0.4});
  CHECK(result.stamps_s == Stamps{0.1, 0.2, 0.3, 0.4});
  REQUIRE(result.warnings.size() == 1);
  CHECK(result.warnings[0].starts_with("1 scan was recorded after a later one"));
}

TEST_CASE("a single scan that is stamped long before the one before is left out") {
  const ReadScans result = read({1.1, 1.2, 0.3, 1.4});
  CHECK(result.stamps_s == Stamps{1.1, 1.2, 1.4});
  CHECK(result.left_out.first.find("stamped 0.300000 s") != std::string::npos);
}

TEST_CASE("stamps that fall back and stay there, or stand, are counted on and rise") {
  CHECK(read({5.1, 5.2, 2.3, 2.4, 2.6}).stamps_s == Stamps{5.1, 5.2, 5.3, 5.4, 5.6});
  const ReadScans standing = read({0.0, 0.0, 0.0, 0.0});
  CHECK(standing.stamps_s == Stamps{0.0, 0.1, 0.2, 0.3});
  CHECK(one_line_with(standing.warnings, "3 scans"));
}

TEST_CASE("stamps in whole seconds are counted on within each second, and no scan is lost") {
  const ReadScans result = read({7.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0, 8.0, 8.0, 9.0});
  CHECK(result.stamps_s == Stamps{7.0, 7.1, 7.2, 7.3, 7.4, 7.5, 7.6, 7.7, 7.8, 7.9, 8.0, 8.1, 9.0});
  CHECK(result.left_out.scans == 0);
  CHECK(read({0.1, 0.1, 0.2, 0.3}).stamps_s == Stamps{0.1, 0.15, 0.2, 0.3});
}
