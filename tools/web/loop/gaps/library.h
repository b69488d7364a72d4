#pragma once
// What the engine's sources use of C++20's library and Emscripten 3.1 lacks; included before them.
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <numeric>
#include <string>

namespace std::ranges {

template <typename Range, typename Value>
auto find(Range&& range, const Value& value) {
  return std::find(std::begin(range), std::end(range), value);
}
template <typename Range, typename Value, typename Projection>
auto find(Range&& range, const Value& value, Projection projection) {
  return std::find_if(std::begin(range), std::end(range), [&](const auto& element) {
    return std::invoke(projection, element) == value;
  });
}
template <typename Range, typename Test>
bool all_of(Range&& range, Test test) {
  return std::all_of(std::begin(range), std::end(range), test);
}
template <typename Range, typename Test>
bool any_of(Range&& range, Test test) {
  return std::any_of(std::begin(range), std::end(range), test);
}
template <typename Range, typename To>
void copy(Range&& range, To to) {
  std::copy(std::begin(range), std::end(range), to);
}
template <typename Range, typename Value>
void fill(Range&& range, const Value& value) {
  std::fill(std::begin(range), std::end(range), value);
}
template <typename A, typename B, typename Same = std::equal_to<>>
bool equal(A&& a, B&& b, Same same = {}) {
  return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b), same);
}
template <typename Range>
void sort(Range&& range) {
  std::sort(std::begin(range), std::end(range));
}
template <typename Range, typename Projection>
void stable_sort(Range&& range, std::less<> before, Projection projection) {
  std::stable_sort(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return before(std::invoke(projection, a), std::invoke(projection, b));
  });
}

}  // namespace std::ranges

namespace std {

inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const std::string text(first, last);
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  value = number;
  return {first + (end - text.c_str()), errc()};
}

}  // namespace std
