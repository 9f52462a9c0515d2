#pragma once

#include <span>
#include <vector>

#include "coordinator/excitation/ground_motion.hpp"

namespace hybridtest {

/// Largest response of a linear oscillator to a ground motion, relative to the ground.
struct SpectrumOrdinate {
  double period_s = 0.0;
  double displacement_m = 0.0;                // largest |u|
  double velocity_m_per_s = 0.0;              // largest |du/dt|
  double pseudo_acceleration_m_per_s2 = 0.0;  // (2 pi / period)^2 times the displacement
};

/// Of u'' + 2 xi w u' + w^2 u = -a_g, from rest, during the motion and one period after it. The recurrence is exact
/// for the piecewise linear motion (Nigam and Jennings, Bulletin of the Seismological Society of America 59, 1969). Its
/// coefficients come from the series of the matrix exponential: the closed form loses digits where the step is a
/// small part of the period. Steps are divided until one is at most a hundredth of the period, so that the largest
/// displacement between two points is some 0.05 % above the one returned at most.
/// @param period_s        positive.
/// @param damping_ratio   not negative.
[[nodiscard]] SpectrumOrdinate spectrum_ordinate(const GroundMotion& motion, double period_s, double damping_ratio);

/// 101 periods from 0.02 to 10 s, evenly spaced by their logarithm.
[[nodiscard]] std::vector<double> spectrum_periods_s();

[[nodiscard]] std::vector<SpectrumOrdinate> response_spectrum(const GroundMotion& motion,
                                                              std::span<const double> periods_s, double damping_ratio);

}  // namespace hybridtest
