// What upsampling and SLAM allocate per scan once they run. Counted is operator new; Eigen goes
// past it for some more.

#include <atomic>
#include <new>

#include "golden_folder.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/sim/drive.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "made_images.h"

namespace {

std::atomic<bool> g_counting{false};
std::atomic<std::int64_t> g_count{0};
std::atomic<std::int64_t> g_bytes{0};

void* counted(std::size_t bytes, std::size_t alignment) {
  if (g_counting) {
    ++g_count;
    g_bytes += static_cast<std::int64_t>(bytes);
  }
  void* memory = nullptr;
  if (posix_memalign(&memory, alignment, bytes) != 0) throw std::bad_alloc();
  return memory;
}

}  // namespace

// Arrays come here too; what may not throw would, but for sanitizers, which answer it themselves.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace {

struct Allocations {
  std::int64_t count = 0;
  std::int64_t bytes = 0;
};

Allocations allocations_of(const auto& call) {
  g_count = g_bytes = 0;
  g_counting = true;
  call();
  g_counting = false;
  return {g_count, g_bytes};
}

constexpr std::int64_t kFloatBytes = 4;

/// The mean over ten scans, after twenty others.
Allocations of_slam(const char* sensor_name) {
  constexpr int kFirst = 20;
  constexpr int kCounted = 10;
  const SensorModel sensor = sensor_preset(sensor_name);
  sim::DriveSimulator simulator({"block", 1, kFirst + kCounted, {}, {}}, sensor);
  slam::SlamOptions options;
  options.threads = 2;
  slam::Slam slam(sensor, options);
  Allocations sum;
  for (int i = 0; const auto scan = simulator.next(); ++i) {
    const OrganizedCloud cloud = unproject(scan->image, sensor, CaptureTime::kRolling);
    const Allocations here = allocations_of([&] { slam.process(cloud, scan->stamp_s); });
    if (i < kFirst) continue;
    sum.count += here.count;
    sum.bytes += here.bytes;
  }
  return {sum.count / kCounted, sum.bytes / kCounted};
}

}  // namespace

// The result (two images), the measured rows, taken out and copied while they grow, and ten small
// pieces: the networks keep the memory that they work in.
TEST_CASE("upsampling a scan allocates what it returns, the measured rows and 10 kB") {
  constexpr std::int64_t kResultBytes = 2 * 64 * 1024 * kFloatBytes;
  constexpr std::int64_t kMeasuredBytes = 16 * 1024 * kFloatBytes;
  for (const char* weights : {"du-mix_any-beams.npz", "du-or_os1_16to64.npz"}) {
    CAPTURE(weights);
    auto resolver =
        nn::SuperResolver::load(golden_folder() + "/../../weights/" + weights, {.threads = 2});
    const RangeImage image =
        made_image(64, 1024, [](int row, int column) { return 5.0 + 0.3 * row + 0.01 * column; });
    resolver.run(image);
    const Allocations second = allocations_of([&] { resolver.run(image); });
    const Allocations allocations = allocations_of([&] { resolver.run(image); });
    CHECK(second.count == allocations.count);
    CHECK(second.bytes == allocations.bytes);
    CHECK(allocations.count <= 20);  // 12
    CHECK(allocations.bytes <= kResultBytes + 2 * kMeasuredBytes + 10'000);
  }
}

// Stages hand their results on by value. Two thirds of the pieces are the rows' lists of features,
// which grow, and what thins them; the others the lists of constraints, of matches and
// of cells of the map.
TEST_CASE("a scan in SLAM allocates a few thousand pieces of less than the scan's size each") {
  const Allocations rows_64 = of_slam("os1-64");
  CHECK(rows_64.count <= 8'000);       // 4,900
  CHECK(rows_64.bytes <= 45'000'000);  // 27 MB
  const Allocations rows_16 = of_slam("os1-16");
  CHECK(rows_16.count <= 4'200);       // 2,500
  CHECK(rows_16.bytes <= 13'000'000);  // 8 MB
}
