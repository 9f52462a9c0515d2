#pragma once

#include <vector>

namespace hybridtest::design_motion {

/// The target of a fit.
struct SpectralTarget {
  std::vector<double> period_s;
  std::vector<double> pseudo_acceleration_m_per_s2;  // one per period, positive
  double damping_ratio = 0.05;
};

/// How a motion's spectrum compares with its target, S(T)/target over the target's periods.
struct SpectralFit {
  double lowest = 0.0;
  double highest = 0.0;

  /// Largest |S(T)/target - 1|.
  [[nodiscard]] double misfit() const noexcept;
};

[[nodiscard]] SpectralFit spectral_fit(const std::vector<double>& acceleration_m_per_s2, double dt_s,
                                       const SpectralTarget& target);

/// Fits the response spectrum of a motion in the time domain (Lilhanand and Tseng, 1987, with the
/// wavelets of Al Atik and Abrahamson, 2010).
///
/// At each period, a wavelet is added around the time of the peak response whose response peaks at
/// that very time,
///
///   cos(w'(t - t_p + t_l)) exp(-((t - t_p + t_l)/g)^2),   w' = w sqrt(1 - z^2),
///   t_l = atan(sqrt(1 - z^2)/z)/w',   g = 1.178 f^-0.93 [s], f in Hz;
///
/// the amplitudes solve the linear system that gives every period the change it lacks at its peak
/// time, in the damped least squares sense. Peaks move, so this is repeated, with every second
/// period in turns, ends faded and drift removed every time, and the best of the motions is kept.
///
/// @param acceleration_m_per_s2   the motion to start from, scaled roughly to the target.
/// @param target   at least two periods, in ascending order.
/// @param fade_s   the length of the half cosine waves that bring both ends to zero.
[[nodiscard]] std::vector<double> match_spectrum(std::vector<double> acceleration_m_per_s2, double dt_s,
                                                 const SpectralTarget& target, double fade_s, int iterations);

}  // namespace hybridtest::design_motion
