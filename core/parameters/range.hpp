#pragma once

#include <limits>
#include <string>

namespace hybridtest {

/// Closed or half-open range of a number, for the check and for the error message.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;  // low itself is not allowed
  bool high_open = false;
};
inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{.low = 0.0, .low_open = true};
inline constexpr Range kNotNegative{.low = 0.0};
inline constexpr Range kZeroToOne{.low = 0.0, .high = 1.0};
inline constexpr Range kZeroToBelowOne{.low = 0.0, .high = 1.0, .high_open = true};
inline constexpr Range kBelowOneEitherWay{.low = -1.0, .high = 1.0, .low_open = true, .high_open = true};

[[nodiscard]] bool contains(const Range& range, double value) noexcept;
/// `0 to 10`, `more than 0, at most 2`, `0 to below 1`, `any`: for tables and for messages with a reason.
[[nodiscard]] std::string values_in(const Range& range);
/// `a number greater than 0`, for messages.
[[nodiscard]] std::string expected_number(const Range& range);

}  // namespace hybridtest
