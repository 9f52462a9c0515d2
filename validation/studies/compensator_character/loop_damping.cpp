#include "validation/studies/compensator_character/loop_damping.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "validation/studies/compensator_character/driven_target.hpp"

namespace hybridtest::character {
namespace {

constexpr int kCycles = 40;
/// Part of the record in which the logarithm of the amplitude is taken as linear; before it is start-up.
constexpr int kFirstCycle = 12;
/// The run ends after growth or decay by this factor; further values would leave the range of numbers or of noise.
constexpr double kEnough = 1e8;

/// Slope of a straight line by least squares.
class Slope {
 public:
  void add(double x, double y) noexcept {
    ++count_;
    x_ += x;
    y_ += y;
    xx_ += x * x;
    xy_ += x * y;
  }
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] double value() const noexcept { return (count_ * xy_ - x_ * y_) / (count_ * xx_ - x_ * x_); }

 private:
  int count_ = 0;
  double x_ = 0.0;
  double y_ = 0.0;
  double xx_ = 0.0;
  double xy_ = 0.0;
};

/// Explicit Newmark of x'' + 2 zeta omega x' + f = 0, f the restoring force over the mass. The target's velocity
/// and acceleration are those that the coordinator knows when it sends the target.
class FreeVibration {
 public:
  FreeVibration(double omega, double damping, double step_s)
      : damping_per_s_{2.0 * damping * omega}, step_s_{step_s}, state_{0.0, omega * kAmplitudeM, 0.0} {
    state_.acceleration_m_per_s2 = -damping_per_s_ * state_.velocity_m_per_s;
  }
  [[nodiscard]] Motion next_target() const noexcept {
    const auto& [x, v, a] = state_;
    return {x + step_s_ * v + 0.5 * step_s_ * step_s_ * a, v + step_s_ * a, a};
  }
  void accept(const Motion& target, double restoring_m_per_s2) noexcept {
    const double half_s = 0.5 * step_s_;
    const double carried = state_.velocity_m_per_s + half_s * state_.acceleration_m_per_s2;
    const double a = -(restoring_m_per_s2 + damping_per_s_ * carried) / (1.0 + half_s * damping_per_s_);
    state_ = {target.displacement_m, carried + half_s * a, a};
  }
  [[nodiscard]] const Motion& state() const noexcept { return state_; }

 private:
  double damping_per_s_;
  double step_s_;
  Motion state_;
};

}  // namespace

double measured_loop_damping(const CompensationMethod& method, double omega_delay, double damping) {
  const StandKind stand = pure_delay_stand();
  const double omega = omega_delay / stand.delay_s;
  // Force over stiffness times omega squared is force over mass.
  const double force_over_mass = omega * omega / stand.stiffness_n_per_m;
  MeasuredLoop loop{method, stand};
  FreeVibration structure{omega, damping, stand.period_s};
  const auto per_cycle = static_cast<int>(std::lround(2.0 * std::numbers::pi / (omega * stand.period_s)));
  Slope slope;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    double square = 0.0;
    for (int i = 0; i < per_cycle; ++i) {
      const Motion target = structure.next_target();
      structure.accept(target, force_over_mass * loop.advance(target, {}).structure_force_n);
      const Motion& state = structure.state();
      square += std::pow(state.displacement_m, 2) + std::pow(state.velocity_m_per_s / omega, 2);
    }
    const double amplitude = std::sqrt(square / per_cycle) / kAmplitudeM;
    const bool is_enough = !(amplitude < kEnough) || amplitude < 1.0 / kEnough;
    // Fast growth can end the run during the start-up.
    if (!is_enough && (cycle >= kFirstCycle || amplitude > 1e3))
      slope.add(cycle * per_cycle * stand.period_s, std::log(amplitude));
    if (is_enough && slope.count() < 2) return amplitude > 1.0 || std::isnan(amplitude) ? -1.0 : 1.0;
    if (is_enough) break;
  }
  return -slope.value() / omega;
}

StabilityLimit stability_limit(const std::vector<double>& omega_delays, const std::vector<double>& dampings) {
  for (std::size_t i = 0; i < omega_delays.size(); ++i) {
    if (dampings[i] >= 0.0) continue;
    if (i == 0) return {omega_delays[0], true};
    const double share = dampings[i - 1] / (dampings[i - 1] - dampings[i]);
    return {omega_delays[i - 1] + share * (omega_delays[i] - omega_delays[i - 1]), true};
  }
  return {omega_delays.back(), false};
}

}  // namespace hybridtest::character
