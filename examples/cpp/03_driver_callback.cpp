#include <hqslam/core/projection.h>
#include <hqslam/pipeline/pipeline.h>
#include <hqslam/recordings/recording.h>

#include <condition_variable>
#include <iostream>
#include <mutex>
#include <thread>

// A driver's callback hands over the points of each turn, which a thread of its own locates.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  auto recording = hqslam::recordings::Recording::open(argv[1]);  // it plays the driver here
  hqslam::pipeline::Pipeline pipeline(recording.sensor());
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<hqslam::Scan> waiting;
  const auto hand_over = [&](std::optional<hqslam::Scan> points) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return !waiting; });  // a sensor would replace the waiting scan
    waiting = std::move(points);
    changed.notify_all();
  };
  std::jthread slam([&] {
    while (true) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return waiting.has_value(); });
      const hqslam::Scan points = *std::exchange(waiting, std::nullopt);
      changed.notify_all();
      lock.unlock();
      if (points.points_m.empty()) return;  // no further scan
      std::cout << pipeline.process(points).report.T_map_sensor.translation().transpose() << '\n';
    }
  });
  while (const auto scan = recording.next()) {
    hqslam::Scan points = hqslam::returns_of(scan->cloud);  // x y z, row, time after the stamp
    points.stamp_s = scan->stamp_s;
    hand_over(points);
  }
  hand_over(hqslam::Scan());
}
