#include "diagnosis/localisation/localise.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/assert.hpp"
#include "diagnosis/localisation/reversals.hpp"
#include "diagnosis/localisation/spectra.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kLeastSamples = 64;
constexpr std::size_t kTimeWindows = 40;
constexpr std::size_t kParameterWindows = 16;
constexpr std::size_t kMotionBins = 6;
constexpr std::size_t kReversalBins = 16;
constexpr std::size_t kMostCycleBins = 16;
constexpr double kBetterPart = 0.5;

}  // namespace

std::vector<GapRegion> regions_holding(const MotionMap& map, double share) {
  std::vector<std::size_t> order(map.cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return map.cells[i].share; });
  const auto samples = std::accumulate(map.cells.begin(), map.cells.end(), 0.0, [](double sum, const GapBin& cell) {
    return sum + static_cast<double>(cell.samples);
  });
  const double width_m = map.peak_m / static_cast<double>(map.displacement_bins);
  const double width_m_per_s = map.peak_m_per_s / static_cast<double>(map.velocity_bins);
  std::vector<GapRegion> regions;
  double held = 0.0;
  for (const std::size_t i : order) {
    if (held >= share || map.cells[i].share <= 0.0) break;
    held += map.cells[i].share;
    const std::size_t whole_rows = i / map.displacement_bins;
    const auto column = static_cast<double>(i % map.displacement_bins);
    const auto row = static_cast<double>(whole_rows);
    regions.push_back({.displacement_low_m = column * width_m,
                       .displacement_high_m = (column + 1.0) * width_m,
                       .velocity_low_m_per_s = row * width_m_per_s,
                       .velocity_high_m_per_s = (row + 1.0) * width_m_per_s,
                       .share = map.cells[i].share,
                       .time_share = static_cast<double>(map.cells[i].samples) / samples});
  }
  return regions;
}

Localisation localise(const GapSignals& signals, InterfaceKind kind) {
  HYBRIDTEST_ASSERT(signals.size() >= kLeastSamples && signals.input_m.size() == signals.size() &&
                    signals.measured.size() == signals.size());
  const double output = mean_square(signals.measured);
  Localisation found;
  found.nrmse = output > 0.0 ? std::sqrt(mean_square(signals.residual) / output) : 0.0;
  found.floor = repeatability_floor(signals);
  found.windows = gap_over_time(signals, kTimeWindows);
  found.bands = gap_over_frequency(
      signals, welch(signals.input_m, signals.residual, signals.period_s, welch_segment(signals.size())));
  found.motion = gap_over_motion(signals, kMotionBins, kMotionBins);
  const auto turns = reversals_of(signals.input_m, reversal_threshold_m(signals.input_m));
  found.since_reversal = gap_over(signals, distance_since_reversal_m(signals.input_m, turns), kReversalBins);
  const std::vector<double> cycles = cycles_completed(signals.size(), turns);
  const std::size_t cycle_bins = std::clamp<std::size_t>(turns.size() / 2, 1, kMostCycleBins);
  found.over_cycles = gap_over(signals, cycles, cycle_bins);
  found.parameters = parameters_over_time(signals, kind, kParameterWindows);
  found.drifts = drift_of(found.parameters, kind);
  if (kind == InterfaceKind::displacement_out) {
    found.tracking = evaluate_tracking_frequency(signals.input_m, signals.measured, signals.period_s);
  }
  found.main_windows = windows_holding(found.windows, kBetterPart);
  found.main_bands = bands_holding(found.bands, kBetterPart);
  return found;
}

}  // namespace hybridtest
