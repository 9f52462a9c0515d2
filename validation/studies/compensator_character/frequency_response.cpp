#include "validation/studies/compensator_character/frequency_response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "validation/studies/compensator_character/driven_target.hpp"

namespace hybridtest::character {
namespace {

constexpr double kRunAwayM = 1e3;
/// Adaptive methods look back over seconds.
constexpr double kSettleS = 8.0;
constexpr double kSettleCycles = 10.0;
constexpr double kMeasureS = 2.0;

/// Least squares of a signal on sine and cosine of one frequency.
class SinePair {
 public:
  void add(double angle, double value) noexcept {
    const Eigen::Vector2d row{std::sin(angle), std::cos(angle)};
    normal_ += row * row.transpose();
    right_ += row * value;
  }
  /// Amplitude and phase against the sine.
  [[nodiscard]] std::complex<double> phasor() const {
    const Eigen::Vector2d solution = normal_.ldlt().solve(right_);
    return {solution(0), solution(1)};
  }

 private:
  Eigen::Matrix2d normal_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_ = Eigen::Vector2d::Zero();
};

std::complex<double> target_force_n(const StandKind& stand, double omega) {
  return kAmplitudeM *
         std::complex<double>{stand.stiffness_n_per_m - stand.mass_kg * omega * omega, stand.damping_n_s_per_m * omega};
}

}  // namespace

std::complex<double> measured_response(const CompensationMethod& method, const StandKind& stand, double frequency_hz) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  const double settle_s = std::max(kSettleS, kSettleCycles / frequency_hz);
  const double measure_s = std::ceil(kMeasureS * frequency_hz) / frequency_hz;
  const DrivenTarget target{kAmplitudeM, frequency_hz};
  MeasuredLoop loop{method, stand};
  SinePair fit;
  // When the structure holds the force, it acts half a period late on average.
  const double handed_over_s = stand.has_loop_delay ? 0.5 * stand.period_s : 0.0;
  const auto samples = static_cast<long>((settle_s + measure_s) / stand.period_s);
  for (long i = 0; i < samples; ++i) {
    const double time_s = static_cast<double>(i) * stand.period_s;
    const LoopSample sample = loop.advance(target.at(time_s), {});
    if (!(std::abs(sample.command_m) < kRunAwayM)) return {kNotANumber, kNotANumber};
    if (time_s >= settle_s) fit.add(omega * (time_s + handed_over_s), sample.structure_force_n);
  }
  return fit.phasor() / target_force_n(stand, omega);
}

double effective_delay_s(std::complex<double> response, double frequency_hz) {
  return -std::arg(response) / (2.0 * std::numbers::pi * frequency_hz);
}

std::vector<double> logarithmic_frequencies(double low_hz, double high_hz, int count) {
  std::vector<double> frequencies;
  for (int i = 0; i < count; ++i) {
    frequencies.push_back(low_hz * std::pow(high_hz / low_hz, static_cast<double>(i) / (count - 1)));
  }
  return frequencies;
}

}  // namespace hybridtest::character
