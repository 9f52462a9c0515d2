#include "diagnosis/localisation/localise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/assert.hpp"
#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

struct Stretch {
  std::span<const double> input_m;
  std::span<const double> velocity_m_per_s;
  std::span<const double> output;
};

std::optional<std::pair<double, double>> on_displacement_and_velocity(const Stretch& stretch) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < stretch.input_m.size(); ++i) {
    const Eigen::Vector3d row{stretch.input_m[i], stretch.velocity_m_per_s[i], 1.0};
    normal += row * row.transpose();
    right += row * stretch.output[i];
  }
  // Displacement in metres and velocity in metres per second differ by orders of magnitude from one.
  const Eigen::Vector3d scale = normal.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return {};
  const Eigen::Matrix3d scaled = scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const Eigen::ColPivHouseholderQR<Eigen::Matrix3d> factors{scaled};
  if (factors.rank() < 3) return {};
  const Eigen::Vector3d fitted = factors.solve(right.cwiseQuotient(scale)).cwiseQuotient(scale);
  return std::pair{fitted[0], fitted[1]};
}

/// The two coefficients as amplitude ratio and phase of a sine of that frequency.
std::pair<double, double> gain_and_delay(std::pair<double, double> fitted, double frequency_rad_per_s) {
  const double behind = -fitted.second * frequency_rad_per_s;
  return {std::hypot(fitted.first, behind), std::atan2(behind, fitted.first) / frequency_rad_per_s};
}

/// 0, 1, 2 ... in the order of the values; equal ones share the mean of their places.
Eigen::ArrayXd ranks_of(const std::vector<WindowParameters>& windows, double WindowParameters::*quantity) {
  const auto count = static_cast<Eigen::Index>(windows.size());
  Eigen::ArrayXd ranks(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double own = windows[static_cast<std::size_t>(i)].*quantity;
    const auto below = std::ranges::count_if(windows, [&](const auto& window) { return window.*quantity < own; });
    const auto equal = std::ranges::count_if(windows, [&](const auto& window) { return window.*quantity == own; });
    ranks[i] = static_cast<double>(below) + 0.5 * static_cast<double>(equal - 1);
  }
  return ranks;
}

double correlation(const std::vector<WindowParameters>& windows, double WindowParameters::*first,
                   double WindowParameters::*second) {
  Eigen::ArrayXd a = ranks_of(windows, first);
  Eigen::ArrayXd b = ranks_of(windows, second);
  a -= a.mean();
  b -= b.mean();
  const double product = std::sqrt(a.square().sum() * b.square().sum());
  return product > 0.0 ? (a * b).sum() / product : 0.0;
}

ParameterDrift drift_of_one(const std::vector<WindowParameters>& windows, double WindowParameters::*parameter,
                            std::string name) {
  ParameterDrift drift;
  drift.parameter = std::move(name);
  drift.windows = windows.size();
  const auto count = static_cast<double>(windows.size());
  double square = 0.0;
  for (const WindowParameters& window : windows) drift.mean += window.*parameter / count;
  for (const WindowParameters& window : windows) square += std::pow(window.*parameter - drift.mean, 2) / (count - 1.0);
  drift.spread = drift.mean != 0.0 ? std::sqrt(square) / std::abs(drift.mean) : 0.0;
  drift.with_amplitude = correlation(windows, parameter, &WindowParameters::amplitude_m);
  drift.with_time = correlation(windows, parameter, &WindowParameters::begin_s);
  drift.with_frequency = correlation(windows, parameter, &WindowParameters::frequency_hz);
  return drift;
}

}  // namespace

std::vector<WindowParameters> parameters_over_time(const GapSignals& signals, InterfaceKind kind, std::size_t count) {
  const std::vector<double> velocity = velocity_of(signals.input_m, signals.period_s, tuning::kVelocityReach_s);
  const std::size_t size = signals.size();
  std::vector<WindowParameters> windows;
  for (std::size_t i = 0; i < count && count <= size; ++i) {
    const std::size_t begin = i * size / count;
    const std::size_t length = (i + 1) * size / count - begin;
    const Stretch stretch{signals.input_m.subspan(begin, length), std::span{velocity}.subspan(begin, length),
                          signals.measured.subspan(begin, length)};
    const double displacement = variance(stretch.input_m);
    const double speed = mean_square(stretch.velocity_m_per_s);
    if (!(displacement > 0.0) || !(speed > 0.0)) continue;
    const double frequency_rad_per_s = std::sqrt(speed / displacement);
    auto fitted = on_displacement_and_velocity(stretch);
    if (!fitted) continue;
    if (kind == InterfaceKind::displacement_out) fitted = gain_and_delay(*fitted, frequency_rad_per_s);
    windows.push_back({.begin_s = static_cast<double>(begin) * signals.period_s,
                       .end_s = static_cast<double>(begin + length) * signals.period_s,
                       .amplitude_m = std::sqrt(2.0 * displacement),
                       .frequency_hz = frequency_rad_per_s / (2.0 * std::numbers::pi),
                       .first = fitted->first,
                       .second = fitted->second});
  }
  double largest_m = 0.0;
  for (const WindowParameters& window : windows) largest_m = std::max(largest_m, window.amplitude_m);
  std::erase_if(windows,
                [&](const auto& window) { return window.amplitude_m < tuning::kWindowAmplitudeMin * largest_m; });
  return windows;
}

bool ParameterDrift::is_significant(double correlation) const noexcept {
  if (windows < tuning::kDriftWindowsMin) return false;
  const double bounded = std::clamp(correlation, -tuning::kRankCorrelationMax, tuning::kRankCorrelationMax);
  return std::abs(std::atanh(bounded)) * std::sqrt(static_cast<double>(windows) - 3.0) > tuning::kTwoSided99;
}

std::vector<ParameterDrift> drift_of(const std::vector<WindowParameters>& windows, InterfaceKind kind) {
  if (windows.size() < tuning::kDriftWindowsMin) return {};
  const bool is_force = kind == InterfaceKind::force_out;
  return {drift_of_one(windows, &WindowParameters::first, is_force ? "stiffness_n_per_m" : "gain"),
          drift_of_one(windows, &WindowParameters::second, is_force ? "damping_n_s_per_m" : "delay_s")};
}

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
  HYBRIDTEST_ASSERT(signals.size() >= tuning::kLocaliseSamplesMin && signals.input_m.size() == signals.size() &&
                    signals.measured.size() == signals.size());
  const double output = mean_square(signals.measured);
  Localisation found;
  found.nrmse = output > 0.0 ? std::sqrt(mean_square(signals.residual) / output) : 0.0;
  found.floor = repeatability_floor(signals);
  found.windows = gap_over_time(signals, tuning::kTimeWindows);
  found.bands = gap_over_frequency(
      signals, welch(signals.input_m, signals.residual, signals.period_s, welch_segment(signals.size())));
  found.motion = gap_over_motion(signals, tuning::kMotionBins, tuning::kMotionBins);
  const auto turns = reversals_of(signals.input_m, reversal_threshold_m(signals.input_m));
  found.since_reversal = gap_over(signals, distance_since_reversal_m(signals.input_m, turns), tuning::kReversalBins);
  const std::vector<double> cycles = cycles_completed(signals.size(), turns);
  const std::size_t cycle_bins = std::clamp<std::size_t>(turns.size() / 2, 1, tuning::kCycleBinsMax);
  found.over_cycles = gap_over(signals, cycles, cycle_bins);
  found.parameters = parameters_over_time(signals, kind, tuning::kParameterWindows);
  found.drifts = drift_of(found.parameters, kind);
  if (kind == InterfaceKind::displacement_out) {
    found.tracking = evaluate_tracking_frequency(signals.input_m, signals.measured, signals.period_s);
  }
  found.main_windows = windows_holding(found.windows, tuning::kMainShare);
  found.main_bands = bands_holding(found.bands, tuning::kMainShare);
  return found;
}

}  // namespace hybridtest
