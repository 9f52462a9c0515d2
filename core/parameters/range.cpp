#include "core/parameters/range.hpp"

#include <cmath>

#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

std::string bounds(const Range& range) {
  const bool has_low = std::isfinite(range.low);
  const bool has_high = std::isfinite(range.high);
  const std::string low = written_number(range.low);
  const std::string high = written_number(range.high);
  if (has_low && has_high && !range.low_open && !range.high_open) return " from " + low + " to " + high;
  std::string text;
  if (has_low) text += (range.low_open ? " greater than " : " of at least ") + low;
  if (has_low && has_high) text += " and";
  const char* const at_most = has_low ? " at most " : " of at most ";
  if (has_high) text += (range.high_open ? " less than " : at_most) + high;
  return text;
}

}  // namespace

bool contains(const Range& range, double value) noexcept {
  const bool above = range.low_open ? value > range.low : value >= range.low;
  const bool below = range.high_open ? value < range.high : value <= range.high;
  return above && below;
}

std::string values_in(const Range& range) {
  const bool has_low = std::isfinite(range.low);
  const bool has_high = std::isfinite(range.high);
  const std::string low = written_number(range.low);
  const std::string high = written_number(range.high);
  if (!has_low && !has_high) return "any";
  if (has_low && has_high && !range.low_open) return low + (range.high_open ? " to below " : " to ") + high;
  std::string text;
  if (has_low) text = (range.low_open ? "more than " : "at least ") + low;
  if (has_high) text += (has_low ? ", " : "") + std::string{range.high_open ? "less than " : "at most "} + high;
  return text;
}

std::string expected_number(const Range& range) {
  const std::string text = bounds(range);
  return text.empty() ? "a finite number" : "a number" + text;
}

}  // namespace hybridtest
