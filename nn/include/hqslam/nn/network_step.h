#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace hqslam::nn {

/// A part of a network that can be run by itself, to be measured.
struct NetworkStep {
  std::string name;                ///< "encoder.0"
  int calls = 1;                   ///< for one scan
  std::int64_t multiply_adds = 0;  ///< of one call
  /// On what the last scan left, as often as one likes.
  std::function<void()> run;
  bool by_team = true;  ///< called by all threads of a parallel region, which share the work
  /// The same, written as its formula, by one thread; empty if there is no such thing.
  std::function<void()> reference = {};
};

}  // namespace hqslam::nn
