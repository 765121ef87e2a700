#pragma once

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iterator>
#include <string>
#include <system_error>
#include <type_traits>

/// The parts of C++20 that the library uses and the standard library of emscripten 3.1.6 lacks. This file is
/// included before every other one, and is empty where the standard library has them. Ranges are passed by
/// reference, so that no iterator dangles.
#if !defined(__cpp_lib_bit_cast)

namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

/// Reads a decimal number as strtod does in the locale "C", which is the only one there; of what that
/// accepts beyond std::from_chars, neither blanks, a plus sign nor hexadecimal digits.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* digits = first != last && *first == '-' ? first + 1 : first;
  const bool is_number =
      digits != last && ((*digits >= '0' && *digits <= '9') || *digits == '.' || *digits == 'i' ||
                         *digits == 'I' || *digits == 'n' || *digits == 'N');
  if (!is_number)
    return {first, errc::invalid_argument};
  const string text(first, last);
  const size_t hexadecimal = text.find_first_of("xX");
  if (hexadecimal != string::npos && hexadecimal == static_cast<size_t>(digits - first) + 1 &&
      *digits == '0') {
    value = *first == '-' ? -0.0 : 0.0;
    return {digits + 1, errc{}};
  }
  char* end = nullptr;
  const double read = strtod(text.c_str(), &end);
  if (end == text.c_str())
    return {first, errc::invalid_argument};
  const char* rest = first + (end - text.c_str());
  const bool is_infinite = read > 1.7976931348623157e308 || read < -1.7976931348623157e308;
  if (is_infinite && *digits >= '0' && *digits <= '9')
    return {rest, errc::result_out_of_range};
  value = read;
  return {rest, errc{}};
}

namespace ranges {

struct Same {
  template <class Value>
  constexpr Value&& operator()(Value&& value) const {
    return static_cast<Value&&>(value);
  }
};

template <class Range, class Value, class Projection = Same>
constexpr auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& element) { return std::invoke(projection, element) == value; });
}

template <class Range, class Predicate>
constexpr auto find_if(Range&& range, Predicate predicate) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& element) { return std::invoke(predicate, element); });
}

template <class Range, class Value, class Projection = Same>
constexpr auto count(Range&& range, const Value& value, Projection projection = {}) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](const auto& element) { return std::invoke(projection, element) == value; });
}

template <class Range, class Predicate>
constexpr bool any_of(Range&& range, Predicate predicate) {
  return ranges::find_if(range, predicate) != std::end(range);
}

template <class Range, class Predicate>
constexpr bool none_of(Range&& range, Predicate predicate) {
  return !ranges::any_of(range, predicate);
}

template <class Range, class Predicate>
constexpr bool all_of(Range&& range, Predicate predicate) {
  return std::all_of(std::begin(range), std::end(range),
                     [&](const auto& element) { return std::invoke(predicate, element); });
}

template <class Range, class Less = std::less<>>
constexpr auto min_element(Range&& range, Less less = {}) {
  return std::min_element(std::begin(range), std::end(range), less);
}

template <class Range>
constexpr void reverse(Range&& range) {
  std::reverse(std::begin(range), std::end(range));
}

}  // namespace ranges
}  // namespace std

#endif
