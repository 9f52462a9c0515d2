#pragma once

#include <string>

namespace hybridtest {

enum class Sign : unsigned char { when_negative, always };

/// A number of a table or a display: `decimals` digits behind the point, or three significant digits and an exponent
/// for magnitudes of 1e7 and more, so that no number fills the screen.
[[nodiscard]] std::string short_number(double value, int decimals, Sign sign = Sign::when_negative);

}  // namespace hybridtest
