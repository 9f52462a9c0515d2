#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "diagnosis/localisation/gap_signals.hpp"

namespace hybridtest {

/// Energy of the residual where some quantity lies in a range.
struct GapBin {
  double low = 0.0;
  double high = 0.0;
  std::size_t samples = 0;
  double share = 0.0;  // of the residual's energy
  double nrmse = 0.0;  // root mean square of the residual here over that of the whole output
};

/// Over one quantity per sample (distance since reversal, cycles completed): `bins` ranges of equal
/// width from 0 to its largest value.
[[nodiscard]] std::vector<GapBin> gap_over(const GapSignals& signals, std::span<const double> quantity,
                                           std::size_t bins);

/// Over |displacement| and |velocity| of the input, as a table; cells without samples have none.
struct MotionMap {
  double peak_m = 0.0;
  double peak_m_per_s = 0.0;
  std::size_t displacement_bins = 0;
  std::size_t velocity_bins = 0;
  std::vector<GapBin> cells;  // row by row, a row being a range of velocity; low and high are not filled

  [[nodiscard]] const GapBin& at(std::size_t displacement_bin, std::size_t velocity_bin) const {
    return cells[velocity_bin * displacement_bins + displacement_bin];
  }
};
[[nodiscard]] MotionMap gap_over_motion(const GapSignals& signals, std::size_t displacement_bins,
                                        std::size_t velocity_bins);

/// Central differences over `reach_s` either way, shorter at the ends. For maps and screens: noise of a
/// displacement shrinks with the reach, motion faster than about 0.1 / reach is damped.
[[nodiscard]] std::vector<double> velocity_of(std::span<const double> displacement_m, double period_s, double reach_s);

/// For velocity_of(): quiet enough for 10 um of noise, short enough for motions up to 20 Hz.
inline constexpr double kVelocityReach_s = 0.005;

}  // namespace hybridtest
