#include "experimental_site/rigs/checksum.hpp"

#include <array>

namespace hybridtest {
namespace {

/// The remainder of each single byte.
constexpr std::array<std::uint32_t, 256> kRemainders = [] {
  constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320U;
  std::array<std::uint32_t, 256> remainders{};
  for (std::uint32_t byte = 0; byte < remainders.size(); ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kReflectedPolynomial : 0U);
    }
    remainders[byte] = remainder;
  }
  return remainders;
}();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes) noexcept {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    remainder = (remainder >> 8U) ^ kRemainders[(remainder ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~remainder;
}

}  // namespace hybridtest
