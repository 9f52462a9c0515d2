#pragma once

#include <optional>
#include <vector>

#include "core/signal/frequency_evaluation.hpp"
#include "diagnosis/localisation/band_shares.hpp"
#include "diagnosis/localisation/floor.hpp"
#include "diagnosis/localisation/gap_maps.hpp"
#include "diagnosis/localisation/gap_signals.hpp"
#include "diagnosis/localisation/time_windows.hpp"
#include "diagnosis/localisation/window_parameters.hpp"

namespace hybridtest {

/// A part of the (|displacement|, |velocity|) plane with its share of the residual's energy.
struct GapRegion {
  double displacement_low_m = 0.0;
  double displacement_high_m = 0.0;
  double velocity_low_m_per_s = 0.0;
  double velocity_high_m_per_s = 0.0;
  double share = 0.0;
  double time_share = 0.0;  // of the recording that is spent there
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

  // What holds the better part, half of the energy, in few words.
  std::vector<TimeWindow> main_windows;
  std::vector<BandShare> main_bands;
};

/// @param signals   at least 64 samples.
[[nodiscard]] Localisation localise(const GapSignals& signals, InterfaceKind kind);

/// The fewest cells of the map that hold `share` of the energy, largest first.
[[nodiscard]] std::vector<GapRegion> regions_holding(const MotionMap& map, double share);

}  // namespace hybridtest
