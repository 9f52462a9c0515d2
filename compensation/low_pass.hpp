#pragma once

#include <array>

#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Of a compensator's low-pass.
inline constexpr ParameterRule kFilterHz{.range = kPositive,
                                         .what = "corner of the low-pass on both signals",
                                         .values = "0.001 to 0.45 of the control rate"};

/// Butterworth low-pass of fourth order, two second-order sections by the bilinear transform with
/// its frequency axis corrected at the corner:
///
///     H(s) = product over i of 1 / (s^2 + d_i s + 1),   d_i = 2 sin(pi/8), 2 sin(3 pi/8),   s = i w / w_corner
///
/// Starts from rest. Delays low frequencies by 0.416 / corner_hz; where delays matter, both signals
/// that are compared pass the same filter.
class LowPass {
 public:
  /// @throws ConfigError for a corner outside 0.001 to 0.45 of the sample rate.
  LowPass(double corner_hz, double sample_period_s);

  /// @param value   finite: the filter would not recover from anything else.
  [[nodiscard]] double filter(double value) noexcept;
  void reset() noexcept;

 private:
  struct Section {
    double b = 0.0;  // numerator b (1 + z^-1)^2
    double a1 = 0.0;
    double a2 = 0.0;
    double first = 0.0;  // states of the transposed direct form
    double second = 0.0;
  };
  std::array<Section, 2> sections_{};
};

}  // namespace hybridtest
