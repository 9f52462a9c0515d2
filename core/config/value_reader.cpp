#include "core/config/value_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/wording.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

namespace hybridtest::config {
namespace {

/// What to change in a scalar that should be a number.
std::string number_advice(const Node& node) {
  if (node.quoted && read_real(node.text).form == NumberForm::number) return "; a number is written without quotes";
  if (node.text.starts_with("0x") || node.text.starts_with("0X")) return "; numbers are decimal";
  return {};
}

/// The same for an integer; 1e4 is a likely way to write one.
std::string integer_advice(const Node& node) {
  constexpr double kExactIntegers = 0x1p53;
  const Real real = read_real(node.text);
  const bool is_integral =
      real.form == NumberForm::number && std::abs(real.value) <= kExactIntegers && std::trunc(real.value) == real.value;
  if (!node.quoted && is_integral)
    return "; an integer is written " + written_integer(static_cast<std::int64_t>(real.value));
  return number_advice(node);
}

}  // namespace

std::string expected_integer(std::int64_t low, std::int64_t high) {
  const bool has_low = low != std::numeric_limits<std::int64_t>::min();
  const bool has_high = high != std::numeric_limits<std::int64_t>::max();
  if (has_low && has_high) return "an integer from " + written_integer(low) + " to " + written_integer(high);
  if (has_low) return "an integer of at least " + written_integer(low);
  if (has_high) return "an integer of at most " + written_integer(high);
  return "an integer";
}

double usable(const Range& range) noexcept {
  for (const double small : {1.0, 0.0, -1.0})
    if (contains(range, small)) return small;
  if (std::isfinite(range.low) && std::isfinite(range.high)) return range.low + 0.5 * (range.high - range.low);
  return std::isfinite(range.low) ? range.low + std::max(1.0, std::abs(range.low))
                                  : range.high - std::max(1.0, std::abs(range.high));
}

std::int64_t usable(std::int64_t low, std::int64_t high) noexcept {
  return std::min(std::max(std::int64_t{1}, low), high);
}

bool ValueReader::is(Node::Kind kind, const Node& node, std::string_view path, std::string_view expected) {
  if (node.kind == kind) return true;
  if (node.kind != Node::Kind::refused) report_mismatch(node, path, expected);
  return false;
}

void ValueReader::report_mismatch(const Node& node, std::string_view path, std::string_view expected,
                                  std::string_view advice) {
  std::string what = "expected ";
  what += expected;
  what += ", found " + described(node);
  what += advice;
  section_.report(node.place, path, what);
}

std::optional<double> ValueReader::number(const Node& node, std::string_view path, const Range& range) {
  const std::string expected = expected_number(range);
  if (!is(Node::Kind::scalar, node, path, expected)) return std::nullopt;
  const Real real = node.quoted ? Real{} : read_real(node.text);
  if (real.form == NumberForm::number && contains(range, real.value)) return real.value;
  if (real.form == NumberForm::number) {
    section_.report(node.place, path, shown(node.text) + " is out of range; expected " + expected);
  } else if (real.form == NumberForm::not_representable) {
    section_.report(node.place, path, shown(node.text) + " is beyond double precision; expected " + expected);
  } else {
    report_mismatch(node, path, expected, number_advice(node));
  }
  return std::nullopt;
}

std::optional<std::int64_t> ValueReader::integer(const Node& node, std::string_view path, std::int64_t low,
                                                 std::int64_t high) {
  const std::string expected = expected_integer(low, high);
  if (!is(Node::Kind::scalar, node, path, expected)) return std::nullopt;
  const Whole whole = node.quoted ? Whole{} : read_whole(node.text);
  if (whole.form == NumberForm::number && whole.value >= low && whole.value <= high) return whole.value;
  if (whole.form == NumberForm::number || whole.form == NumberForm::not_representable) {
    section_.report(node.place, path, shown(node.text) + " is out of range; expected " + expected);
  } else {
    report_mismatch(node, path, expected, integer_advice(node));
  }
  return std::nullopt;
}

std::optional<bool> ValueReader::boolean(const Node& node, std::string_view path) {
  constexpr std::string_view kExpected = "true or false";
  if (!is(Node::Kind::scalar, node, path, kExpected)) return std::nullopt;
  if (!node.quoted && (node.text == "true" || node.text == "false")) return node.text == "true";
  report_mismatch(node, path, kExpected);
  return std::nullopt;
}

std::optional<std::string> ValueReader::text(const Node& node, std::string_view path, std::string_view expected) {
  if (!is(Node::Kind::scalar, node, path, expected)) return std::nullopt;
  const bool is_text = node.quoted || (read_real(node.text).form == NumberForm::not_a_number && node.text != "true" &&
                                       node.text != "false");
  if (is_text) return node.text;
  report_mismatch(node, path, expected, "; a text that looks like something else is written in quotes");
  return std::nullopt;
}

}  // namespace hybridtest::config
