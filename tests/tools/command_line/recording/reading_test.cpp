#include "recording/reading.h"

#include <csignal>

#include "made_scans.h"

namespace hqslam::tools {
namespace {

/// Scans of which some throw.
MadeScans made(std::vector<std::function<void()>> scans) {
  const std::size_t size = scans.size();
  return {size, [scans = std::move(scans)](std::size_t i) {
            scans[i]();
            RecordedScan scan;
            scan.name = "scan " + std::to_string(i);
            return scan;
          }};
}

void good() {}
void not_understood() { throw ScanError("has no points"); }
void unreadable() { throw Error("a.bin: cannot be read"); }

/// The indices that were used, as far as `goes_on` says or to the end.
std::vector<std::int64_t> used_of(
    std::vector<std::function<void()>> scans, Reading& reading, const LookAhead& look_ahead = {},
    const std::function<bool(std::int64_t)>& goes_on = [](std::int64_t) { return true; }) {
  MadeScans source = made(std::move(scans));
  const InterruptGuard interrupt;
  std::vector<std::int64_t> used;
  const auto use = [&](const ReadScan& read) {
    const bool result = goes_on(read.index);
    used.push_back(read.index);
    return result;
  };
  read_scans(source, interrupt, reading, use, look_ahead);
  return used;
}

}  // namespace

TEST_CASE("scans that cannot be understood are left out, counted, and keep their index") {
  Reading reading;
  CHECK(used_of({good, not_understood, not_understood, good}, reading) ==
        std::vector<std::int64_t>{0, 3});
  CHECK(reading.end == ReadingEnd::kComplete);
  CHECK(reading.left_out.text() == "2 scans were left out, the first of them: has no points");
}

TEST_CASE("a scan that cannot be read ends the reading, unless it is the first") {
  Reading reading;
  CHECK(used_of({good, good, unreadable, good}, reading) == std::vector<std::int64_t>{0, 1});
  CHECK(reading.end == ReadingEnd::kUnreadableScan);
  CHECK(reading.end_message == "a.bin: cannot be read");
  Reading none;
  CHECK(refused_with([&] { used_of({unreadable}, none); }, "a.bin"));
}

TEST_CASE("a recording of which nothing can be used says why") {
  Reading reading;
  const std::vector<std::function<void()>> scans(2, not_understood);
  CHECK(refused_with([&] { used_of(scans, reading); }, "2 scans were left out", "no points"));
}

TEST_CASE("the user of the scans may leave one out, or stop") {
  Reading reading;
  const auto goes_on = [](std::int64_t scan) {
    if (scan == 1) throw ScanError("has bad times");
    return scan < 2;
  };
  CHECK(used_of({good, good, good, good}, reading, {}, goes_on) == std::vector<std::int64_t>{0, 2});
  CHECK(reading.end == ReadingEnd::kComplete);
  CHECK(reading.left_out.text() == "1 scan was left out: scan 1: has bad times");
}

TEST_CASE("a scan is used when those that it waits for were seen, or none come") {
  MadeScans source = made({good, not_understood, good, good, good, unreadable});
  const InterruptGuard interrupt;
  Reading reading;
  std::vector<std::int64_t> order;  // seen: negative, from -1
  const auto use = [&](const ReadScan& read) {
    if (read.index == 3) throw ScanError("has bad times");
    order.push_back(read.index);
    return true;
  };
  read_scans(source, interrupt, reading, use,
             {2, [&](const ReadScan& read) { order.push_back(-1 - read.index); }});
  CHECK(order == std::vector<std::int64_t>{-1, -3, -4, 0, -5, 2, 4});
  CHECK(reading.end == ReadingEnd::kUnreadableScan);
  CHECK(reading.left_out.each ==
        std::vector<std::string>{"has no points", "scan 3: has bad times"});
}

TEST_CASE("scans that wait for others are not used when Ctrl-C ends the reading") {
  Reading reading;
  CHECK(used_of({good, good, good, [] { std::raise(SIGINT); }, good}, reading, {2}) ==
        std::vector<std::int64_t>{0, 1});
  CHECK(reading.end == ReadingEnd::kInterrupted);
}

TEST_CASE("a range of scans has as many as the recording holds of it") {
  CHECK(ScanRange{10, 29}.count_of(80) == 20);
  CHECK(ScanRange{10, 29}.count_of(15) == 5);
  CHECK(ScanRange{10, 29}.count_of(10) == 0);
  CHECK(ScanRange{}.count_of(80) == 80);
  CHECK_FALSE(ScanRange{}.count_of(std::nullopt).has_value());
}

}  // namespace hqslam::tools
