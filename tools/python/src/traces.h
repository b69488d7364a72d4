#pragma once

#include <nanobind/stl/optional.h>

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "arrays.h"

namespace hqslam::python {

/// Where a caller wants to see what happened inside: arrays by their names.
using TraceInput = std::optional<nb::typed<nb::dict, nb::str, nb::any>>;

/// Arrays that look at a trace's own memory, which lives as long as any of them.
template <typename Trace>
class TraceArrays {
 public:
  TraceArrays(Trace trace, nb::dict arrays)
      : trace_(new Trace(std::move(trace))),
        owner_(trace_, [](void* kept) noexcept { delete static_cast<Trace*>(kept); }),
        arrays_(std::move(arrays)) {}

  const Trace& trace() const { return *trace_; }
  /// strides: from element to element, in T; none: C order.
  template <typename T>
  void show(std::string_view name, const T* values, std::initializer_list<std::size_t> shape,
            std::initializer_list<std::int64_t> strides = {}) {
    set(name, nb::cast(nb::ndarray<nb::numpy, const T>(values, shape, owner_, strides)));
  }
  void set(std::string_view name, nb::object value) {
    arrays_[nb::str(name.data(), name.size())] = std::move(value);
  }

 private:
  Trace* trace_;
  nb::capsule owner_;
  nb::dict arrays_;
};

}  // namespace hqslam::python
