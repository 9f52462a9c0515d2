#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "compensation/compensator.hpp"
#include "compensation/force_compensator.hpp"

namespace hybridtest {

using Complex = std::complex<double>;

/// Twenty, from `low_hz` to `high_hz`, each the same factor above the one before.
inline std::array<double, 20> twenty_frequencies_hz(double low_hz, double high_hz) {
  std::array<double, 20> frequencies_hz{};
  for (std::size_t i = 0; i < frequencies_hz.size(); ++i) {
    frequencies_hz[i] = low_hz * std::pow(high_hz / low_hz, static_cast<double>(i) / 19.0);
  }
  return frequencies_hz;
}

/// The target of a harmonic motion exp(i w t), its imaginary part, with its derivatives.
inline CompensatorInput harmonic_input(double omega_per_s, Complex phasor) {
  CompensatorInput input;
  input.target_m = phasor.imag();
  input.target_velocity_m_per_s = (Complex{0.0, omega_per_s} * phasor).imag();
  input.target_acceleration_m_per_s2 = -omega_per_s * omega_per_s * phasor.imag();
  return input;
}

/// Drives a new compensator with a sine at twenty frequencies and compares every sample after the first
/// `settling` with amplitude and phase of a closed form.
/// @param make            () -> compensator
/// @param closed_form     (angular frequency) -> Complex
/// @param tolerance       (angular frequency) -> greatest error of a sample
template <class Make, class ClosedForm, class Tolerance>
void expect_frequency_response(Make make, ClosedForm closed_form, Tolerance tolerance, double period_s, int settling,
                               double low_hz = 0.2, double high_hz = 60.0) {
  for (const double frequency_hz : twenty_frequencies_hz(low_hz, high_hz)) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    const Complex response = closed_form(omega);
    auto compensator = make();
    for (int i = 0; i < settling + 200; ++i) {
      const Complex phasor = std::polar(1.0, omega * period_s * i);
      double answer = 0.0;
      if constexpr (requires { compensator.command(CompensatorInput{}); }) {
        answer = compensator.command(harmonic_input(omega, phasor));
      } else {
        answer = compensator.corrected_force({0.0, 0.0, phasor.imag()});
      }
      if (i >= settling) {
        ASSERT_NEAR(answer, (response * phasor).imag(), tolerance(omega)) << frequency_hz << " Hz, sample " << i;
      }
    }
  }
}

}  // namespace hybridtest
