#pragma once

#include <array>
#include <cstdint>

namespace hybridtest {

/// Seeded generator whose bytes do not depend on the standard library: xoshiro256++
/// (Blackman and Vigna, 2021) seeded through splitmix64.
class Random {
 public:
  /// @param seed     any value.
  /// @param stream   streams of one seed are independent of each other.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) noexcept;

  [[nodiscard]] std::uint64_t bits() noexcept;

  /// Uniform in [0, 1), 53 bits.
  [[nodiscard]] double uniform() noexcept;

  /// Uniform in [low, high).
  [[nodiscard]] double uniform(double low, double high) noexcept;

  /// Uniform over 0 .. count - 1. @param count   at least 1.
  [[nodiscard]] std::uint64_t below(std::uint64_t count) noexcept;

  /// Standard normal, Marsaglia's polar method.
  [[nodiscard]] double normal() noexcept;

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace hybridtest
