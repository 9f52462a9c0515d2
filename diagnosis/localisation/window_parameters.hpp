#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/localisation/gap_signals.hpp"

namespace hybridtest {

/// The simplest model of an interface, fitted to one stretch of time alone.
struct WindowParameters {
  double begin_s = 0.0;
  double end_s = 0.0;
  double amplitude_m = 0.0;   // root mean square of the input about its mean, times sqrt 2
  double frequency_hz = 0.0;  // of a sine with the same displacement and velocity: rms v / (2 pi rms x)
  // Specimen: stiffness [N/m] and damping [N s/m] of f = k x + c v + f0. Transfer system: gain [-] and delay [s]
  // that a sine of that frequency has with the same coefficients of displacement and velocity.
  double first = 0.0;
  double second = 0.0;
};

enum class InterfaceKind : std::uint8_t { displacement_out, force_out };

/// @param count   stretches of equal length; those that all but rest (under a twentieth of the largest
///                amplitude), or in which nothing can be fitted, are left out.
[[nodiscard]] std::vector<WindowParameters> parameters_over_time(const GapSignals& signals, InterfaceKind kind,
                                                                 std::size_t count);

/// How a parameter that a linear model holds constant goes with something: rank correlations (Spearman) over
/// the windows, so that only the order counts. With amplitude it is a missing nonlinearity, with time a degradation,
/// with frequency a missing dynamic.
struct ParameterDrift {
  std::string parameter;  // `stiffness_n_per_m`
  double mean = 0.0;
  double spread = 0.0;  // standard deviation over |mean|
  double with_amplitude = 0.0;
  double with_time = 0.0;
  double with_frequency = 0.0;
  std::size_t windows = 0;

  /// Whether a coefficient is more than chance gives one window in a hundred (Fisher's z, two-sided).
  [[nodiscard]] bool is_significant(double correlation) const noexcept;
};

/// Of both parameters; empty for fewer than four windows.
[[nodiscard]] std::vector<ParameterDrift> drift_of(const std::vector<WindowParameters>& windows, InterfaceKind kind);

}  // namespace hybridtest
