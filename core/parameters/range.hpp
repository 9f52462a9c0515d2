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

[[nodiscard]] bool contains(const Range& range, double value) noexcept;
/// `a number greater than 0`, for messages.
[[nodiscard]] std::string expected_number(const Range& range);

}  // namespace hybridtest
