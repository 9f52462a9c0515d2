#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/signal/frequency_evaluation.hpp"
#include "diagnosis/localisation/floor.hpp"
#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/signals/signals.hpp"

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

/// @param count   stretches of equal length; those almost at rest (under a twentieth of the largest
///                amplitude), or without a possible fit, are omitted.
[[nodiscard]] std::vector<WindowParameters> parameters_over_time(const GapSignals& signals, InterfaceKind kind,
                                                                 std::size_t count);

/// Rank correlations (Spearman) over the windows of a parameter that a linear model assumes constant. A correlation
/// with amplitude is a sign of a missing nonlinearity, with time of degradation, with frequency of missing
/// dynamics.
struct ParameterDrift {
  std::string parameter;  // `stiffness_n_per_m`
  double mean = 0.0;
  double spread = 0.0;  // standard deviation over |mean|
  double with_amplitude = 0.0;
  double with_time = 0.0;
  double with_frequency = 0.0;
  std::size_t windows = 0;

  /// Whether a coefficient is significant at the 1 % level (Fisher's z, two-sided).
  [[nodiscard]] bool is_significant(double correlation) const noexcept;
};

/// Of both parameters; empty for fewer than four windows.
[[nodiscard]] std::vector<ParameterDrift> drift_of(const std::vector<WindowParameters>& windows, InterfaceKind kind);

/// A part of the (|displacement|, |velocity|) plane with its share of the residual's energy.
struct GapRegion {
  double displacement_low_m = 0.0;
  double displacement_high_m = 0.0;
  double velocity_low_m_per_s = 0.0;
  double velocity_high_m_per_s = 0.0;
  double share = 0.0;
  double time_share = 0.0;  // of the duration of the recording
};

/// Where inside one interface its gap lies.
struct Localisation {
  double nrmse = 0.0;  // root mean square of the residual over that of the output
  RepeatabilityFloor floor;
  std::vector<TimeWindow> windows;
  std::vector<BandShare> bands;
  MotionMap motion;
  std::vector<GapBin> since_reversal;  // low and high in m
  std::vector<GapBin> over_cycles;     // low and high in cycles completed
  std::vector<WindowParameters> parameters;
  std::vector<ParameterDrift> drifts;
  std::optional<FrequencyEvaluation> tracking;  // of the output against the input, where both are displacements

  // The windows, bands and regions that contain half of the energy.
  std::vector<TimeWindow> main_windows;
  std::vector<BandShare> main_bands;
};

/// @param signals   at least 64 samples.
[[nodiscard]] Localisation localise(const GapSignals& signals, InterfaceKind kind);

/// The fewest cells of the map that hold `share` of the energy, largest first.
[[nodiscard]] std::vector<GapRegion> regions_holding(const MotionMap& map, double share);

}  // namespace hybridtest
