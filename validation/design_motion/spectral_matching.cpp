#include "validation/design_motion/spectral_matching.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "validation/design_motion/baseline.hpp"
#include "validation/design_motion/oscillator.hpp"

namespace hybridtest::design_motion {
namespace {

/// Share of the computed change that is applied. The full change overshoots, because peaks move.
constexpr double kRelaxation = 0.5;
/// Regularisation: small amplitudes against a close fit. Neighbouring wavelets are nearly equal.
constexpr double kRegularisation = 0.03;
/// A wavelet is cut off where its envelope has fallen to exp(-9).
constexpr double kReach = 3.0;

struct Wavelet {
  std::size_t first = 0;  // sample
  std::vector<double> acceleration_m_per_s2;
};

Wavelet wavelet_at(double period_s, double ratio, double peak_time_s, double dt_s, std::size_t count) {
  const double damped = 2.0 * std::numbers::pi / period_s * std::sqrt(1.0 - ratio * ratio);
  const double lag_s = std::atan(std::sqrt(1.0 - ratio * ratio) / ratio) / damped;
  const double width_s = 1.178 * std::pow(period_s, 0.93);
  const double middle_s = peak_time_s - lag_s;
  const auto last = static_cast<double>(count - 1);
  Wavelet wavelet;
  wavelet.first = static_cast<std::size_t>(std::clamp(std::ceil((middle_s - kReach * width_s) / dt_s), 0.0, last));
  const auto end =
      static_cast<std::size_t>(std::clamp(std::floor((middle_s + kReach * width_s) / dt_s), 0.0, last)) + 1;
  for (std::size_t i = wavelet.first; i < end; ++i) {
    const double time_s = static_cast<double>(i) * dt_s - middle_s;
    wavelet.acceleration_m_per_s2.push_back(std::cos(damped * time_s) *
                                            std::exp(-(time_s / width_s) * (time_s / width_s)));
  }
  return wavelet;
}

/// Pseudo-acceleration of an oscillator at a time, the wavelet acting alone.
double response_at(const Wavelet& wavelet, double period_s, double ratio, double time_s, double dt_s) {
  const auto end = static_cast<std::size_t>(std::lround(time_s / dt_s));
  const auto& values = wavelet.acceleration_m_per_s2;
  Oscillator oscillator{period_s, ratio, dt_s};
  double before = 0.0;
  for (std::size_t i = wavelet.first; i < end; ++i) {
    const std::size_t place = i + 1 - wavelet.first;
    const double now = place < values.size() ? values[place] : 0.0;
    oscillator.advance(before, now);
    before = now;
  }
  return oscillator.frequency_rad_per_s() * oscillator.frequency_rad_per_s() * oscillator.displacement_m();
}

void fade_ends(std::vector<double>& acceleration, double dt_s, double fade_s) {
  const auto length = std::min(static_cast<std::size_t>(fade_s / dt_s), acceleration.size() / 2);
  for (std::size_t i = 0; i < length; ++i) {
    const double strength =
        0.5 * (1.0 - std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(length)));
    acceleration[i] *= strength;
    acceleration[acceleration.size() - 1 - i] *= strength;
  }
}

/// Amplitudes that bring every period to its target at its peak time, in the damped least squares
/// sense. @param influence   of each wavelet (column) on each period (row), relative to the target.
Eigen::VectorXd amplitudes_for(const Eigen::MatrixXd& influence, const Eigen::VectorXd& lacking) {
  // In units of each wavelet's own effect, so that the regularisation treats all alike.
  const Eigen::VectorXd own = influence.diagonal().cwiseAbs().cwiseMax(1e-12);
  const Eigen::MatrixXd scaled = influence * own.cwiseInverse().asDiagonal();
  // The plain product: the order of additions of the blocked product depends on the caches of the machine.
  Eigen::MatrixXd normal = scaled.transpose().lazyProduct(scaled);
  normal.diagonal().array() += kRegularisation;
  return normal.ldlt().solve(scaled.transpose() * lacking).cwiseQuotient(own);
}

/// One round: adds the wavelets that the current peaks require.
void correct(std::vector<double>& acceleration, double dt_s, const SpectralTarget& target) {
  const double ratio = target.damping_ratio;
  const auto count = static_cast<Eigen::Index>(target.period_s.size());
  std::vector<PeakResponse> peaks;
  std::vector<Wavelet> wavelets;
  for (const double period_s : target.period_s) {
    peaks.push_back(peak_response(acceleration, dt_s, period_s, ratio));
    wavelets.push_back(wavelet_at(period_s, ratio, peaks.back().time_s, dt_s, acceleration.size()));
  }
  Eigen::MatrixXd influence(count, count);
  Eigen::VectorXd lacking(count);
  for (Eigen::Index row = 0; row < count; ++row) {
    const auto i = static_cast<std::size_t>(row);
    const double wanted = target.pseudo_acceleration_m_per_s2[i];
    const double present = peaks[i].pseudo_acceleration_m_per_s2;
    lacking[row] = std::copysign(1.0, present) - present / wanted;
    for (Eigen::Index column = 0; column < count; ++column) {
      influence(row, column) =
          response_at(wavelets[static_cast<std::size_t>(column)], target.period_s[i], ratio, peaks[i].time_s, dt_s) /
          wanted;
    }
  }
  const Eigen::VectorXd amplitudes = amplitudes_for(influence, lacking);
  for (std::size_t j = 0; j < wavelets.size(); ++j) {
    const double amplitude = kRelaxation * amplitudes[static_cast<Eigen::Index>(j)];
    for (std::size_t i = 0; i < wavelets[j].acceleration_m_per_s2.size(); ++i) {
      acceleration[wavelets[j].first + i] += amplitude * wavelets[j].acceleration_m_per_s2[i];
    }
  }
}

}  // namespace

double SpectralFit::misfit() const noexcept { return std::max(std::abs(lowest - 1.0), std::abs(highest - 1.0)); }

SpectralFit spectral_fit(const std::vector<double>& acceleration_m_per_s2, double dt_s, const SpectralTarget& target) {
  SpectralFit fit{.lowest = std::numeric_limits<double>::infinity(), .highest = 0.0};
  for (std::size_t i = 0; i < target.period_s.size(); ++i) {
    const auto peak = peak_response(acceleration_m_per_s2, dt_s, target.period_s[i], target.damping_ratio);
    const double ratio = std::abs(peak.pseudo_acceleration_m_per_s2) / target.pseudo_acceleration_m_per_s2[i];
    fit.lowest = std::min(fit.lowest, ratio);
    fit.highest = std::max(fit.highest, ratio);
  }
  return fit;
}

namespace {

/// Every second period, beginning with the first or the second.
SpectralTarget every_second(const SpectralTarget& target, std::size_t first) {
  SpectralTarget part;
  part.damping_ratio = target.damping_ratio;
  for (std::size_t i = first; i < target.period_s.size(); i += 2) {
    part.period_s.push_back(target.period_s[i]);
    part.pseudo_acceleration_m_per_s2.push_back(target.pseudo_acceleration_m_per_s2[i]);
  }
  return part;
}

}  // namespace

std::vector<double> match_spectrum(std::vector<double> acceleration_m_per_s2, double dt_s, const SpectralTarget& target,
                                   double fade_s, int iterations) {
  std::vector<double> best = acceleration_m_per_s2;
  double best_misfit = spectral_fit(best, dt_s, target).misfit();
  // Neighbouring wavelets are nearly equal; used in turns, they leave no dips between them.
  const std::array<SpectralTarget, 2> turns = {every_second(target, 0), every_second(target, 1)};
  for (int iteration = 0; iteration < iterations; ++iteration) {
    correct(acceleration_m_per_s2, dt_s, turns[static_cast<std::size_t>(iteration % 2)]);
    fade_ends(acceleration_m_per_s2, dt_s, fade_s);
    remove_drift(acceleration_m_per_s2, dt_s);
    const double misfit = spectral_fit(acceleration_m_per_s2, dt_s, target).misfit();
    if (misfit >= best_misfit) continue;
    best_misfit = misfit;
    best = acceleration_m_per_s2;
  }
  return best;
}

}  // namespace hybridtest::design_motion
