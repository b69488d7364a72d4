#include "known_way.h"

#include <doctest/doctest.h>

using hqslam::slam::KnownWay;

TEST_CASE("a scan of which much less fits than of the last one stands elsewhere") {
  KnownWay way;
  CHECK(!way.leads_elsewhere(0.1));  // nothing was located yet
  way.located(0.5);
  CHECK(!way.leads_elsewhere(0.31));
  CHECK(way.leads_elsewhere(0.29));
  way.not_located(true);
  CHECK(way.leads_elsewhere(0.29));
}

TEST_CASE("the way is lost with the sixth scan in a row that is not located") {
  KnownWay way;
  for (int i = 0; i < 5; ++i) way.not_located(true);
  CHECK(!way.is_lost());
  way.not_located(true);
  CHECK(way.is_lost());
  CHECK(way.unlocated_scans() == 6);
  way.located(0.5);
  CHECK(!way.is_lost());
  CHECK(way.unlocated_scans() == 0);
}

TEST_CASE("one scan to which nothing measured the way makes it unknown until the next is located") {
  KnownWay way;
  way.not_located(true);
  CHECK(way.is_measured());
  way.not_located(false);
  way.not_located(true);
  CHECK(!way.is_measured());
  way.located(0.5);
  CHECK(way.is_measured());
}
