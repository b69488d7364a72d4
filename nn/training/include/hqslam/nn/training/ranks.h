#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace hqslam {

/// The processes that do one job together, each with its number; this class itself is one alone.
///
/// All of them call the same functions in the same order, and each call waits for all. A job of
/// many processes must give the result of one: sums over what `gather` brought together are made in
/// the order of the whole, not of the ranks' own sums.
class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const { return 0; }  ///< 0 to count() - 1
  virtual int count() const { return 1; }

  /// all: one share for each rank, in their order, all of the same size; this rank has filled its
  /// own. Afterwards every rank has all of them.
  template <typename Value>
  void gather(std::span<Value> all) {
    gather_bytes(std::as_writable_bytes(all));
  }

  /// Whether `own` is true on any rank.
  bool any(bool own) {
    std::vector<std::byte> said(static_cast<std::size_t>(count()));
    said[static_cast<std::size_t>(rank())] = std::byte{own};
    gather_bytes(said);
    return std::ranges::any_of(said, [](std::byte one) { return one != std::byte{0}; });
  }
  /// Waits until all ranks call it.
  void wait() { any(false); }

  /// Does the work on rank 0 and then on the others, which find what it wrote and do not begin if
  /// it threw.
  template <typename Work>
  void rank_0_first(const Work& work) {
    if (rank() > 0) wait();
    work();
    if (rank() == 0) wait();
  }

 protected:
  virtual void gather_bytes(std::span<std::byte> /*all*/) {}
};

}  // namespace hqslam
