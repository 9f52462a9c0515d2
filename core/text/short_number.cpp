#include "core/text/short_number.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace hybridtest {

std::string short_number(double value, int decimals, Sign sign) {
  constexpr double kLongest = 1e7;
  const bool is_short = std::abs(value) < kLongest || !std::isfinite(value);
  const char* const format = sign == Sign::always ? (is_short ? "%+.*f" : "%+.*e") : (is_short ? "%.*f" : "%.*e");
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, is_short ? decimals : 2, value);
  return text.data();
}

}  // namespace hybridtest
