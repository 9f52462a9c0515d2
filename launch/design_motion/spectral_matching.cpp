#include "launch/design_motion/spectral_matching.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "launch/design_motion/baseline.hpp"
#include "launch/design_motion/oscillator.hpp"

namespace hybridtest::design_motion {
namespace {

/// Share of the amplitudes that is added: peaks that move make the full change overshoot.
constexpr double kRelaxation = 0.4;
/// Weight of small amplitudes against a close fit; neighbouring wavelets are nearly alike.
constexpr double kRegularisation = 1.0;
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

/// One round: adds the wavelets that the present peaks call for.
void correct(std::vector<double>& acceleration, double dt_s, const SpectralTarget& target) {
  const std::size_t count = target.period_s.size();
  std::vector<PeakResponse> peaks;
  std::vector<Wavelet> wavelets;
  for (const double period_s : target.period_s) {
    peaks.push_back(peak_response(acceleration, dt_s, period_s, target.damping_ratio));
    wavelets.push_back(wavelet_at(period_s, target.damping_ratio, peaks.back().time_s, dt_s, acceleration.size()));
  }
  const auto size = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd influence(size, size);  // relative to the target of the row
  Eigen::VectorXd lacking(size);
  for (std::size_t row = 0; row < count; ++row) {
    const double wanted = target.pseudo_acceleration_m_per_s2[row];
    const double present = peaks[row].pseudo_acceleration_m_per_s2;
    lacking[static_cast<Eigen::Index>(row)] = std::copysign(1.0, present) - present / wanted;
    for (std::size_t column = 0; column < count; ++column) {
      influence(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          response_at(wavelets[column], target.period_s[row], target.damping_ratio, peaks[row].time_s, dt_s) / wanted;
    }
  }
  // Amplitudes in units of each wavelet's own effect, so that the regularisation treats all alike.
  const Eigen::VectorXd own = influence.diagonal().cwiseAbs().cwiseMax(1e-12);
  const Eigen::MatrixXd scaled = influence * own.cwiseInverse().asDiagonal();
  Eigen::MatrixXd normal = scaled.transpose() * scaled;
  normal.diagonal().array() += kRegularisation;
  const Eigen::VectorXd amplitudes =
      (normal.ldlt().solve(scaled.transpose() * lacking)).cwiseQuotient(own) * kRelaxation;
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t i = 0; i < wavelets[j].acceleration_m_per_s2.size(); ++i) {
      acceleration[wavelets[j].first + i] +=
          amplitudes[static_cast<Eigen::Index>(j)] * wavelets[j].acceleration_m_per_s2[i];
    }
  }
}

}  // namespace

double largest_misfit(const std::vector<double>& acceleration_m_per_s2, double dt_s, const SpectralTarget& target) {
  double largest = 0.0;
  for (std::size_t i = 0; i < target.period_s.size(); ++i) {
    const auto peak = peak_response(acceleration_m_per_s2, dt_s, target.period_s[i], target.damping_ratio);
    const double ratio = std::abs(peak.pseudo_acceleration_m_per_s2) / target.pseudo_acceleration_m_per_s2[i];
    largest = std::max(largest, std::abs(ratio - 1.0));
  }
  return largest;
}

std::vector<double> match_spectrum(std::vector<double> acceleration_m_per_s2, double dt_s, const SpectralTarget& target,
                                   double fade_s, int iterations) {
  std::vector<double> best = acceleration_m_per_s2;
  double best_misfit = largest_misfit(best, dt_s, target);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    correct(acceleration_m_per_s2, dt_s, target);
    fade_ends(acceleration_m_per_s2, dt_s, fade_s);
    remove_drift(acceleration_m_per_s2, dt_s);
    const double misfit = largest_misfit(acceleration_m_per_s2, dt_s, target);
    if (misfit >= best_misfit) continue;
    best_misfit = misfit;
    best = acceleration_m_per_s2;
  }
  return best;
}

}  // namespace hybridtest::design_motion
