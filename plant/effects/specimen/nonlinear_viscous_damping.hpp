#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Damping with a power of the velocity beside the model's law, as of a fluid damper whose orifices open under pressure
/// (Seleemah and Constantinou, NCEER-97-0004, 1997); as the law Viscous. In series with it a brace that is not rigid:
/// its stiffness is c over the displacement d by which the force at 1 m/s stretches it (Maxwell's element with a power
/// of the velocity; Makris and Constantinou, J. Struct. Eng. 117, 1991, for the linear one). Two implicit stages of
/// second order, stable however stiff the brace is (SDIRK2; Alexander, SIAM J. Numer. Anal. 14, 1977), for motions that
/// run straight from sample to sample.
class NonlinearViscousDamping final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + f, f = c sign(w) |w|^n, w = v - (d / c) f'";
  static constexpr std::string_view kSource = "Seleemah and Constantinou (1997)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true, .takes_place = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "damping_n_s_per_m",
                      .unit = "N (s/m)ⁿ",
                      .what = "c, the force at 1 m/s",
                      .low = -kUnbounded,
                      .high = kUnbounded,
                      .is_linear = true},
      EffectParameter{
          .name = "exponent", .unit = "", .what = "n, 1: linear", .low = 0.1, .high = 3.0, .neutral = kNoNeutral},
      EffectParameter{.name = "brace_stretch_m",
                      .unit = "m",
                      .what = "d, of its brace by that force; 0: rigid",
                      .low = 0.0,
                      .high = kUnbounded,
                      .fallback = 0.0}};

  NonlinearViscousDamping(std::span<const double> values, double sample_period_s)
      : damping_n_s_per_m_{values[0]}, exponent_{values[1]}, stretch_m_{values[2]}, sample_period_s_{sample_period_s} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n += damping_n_s_per_m_ * (stretch_m_ > 0.0 ? braced(sample.motion) : power(sample.motion.velocity_m_per_s));
  }
  void reset() noexcept override { displacement_m_ = share_ = root_ = 0.0; }

 private:
  static constexpr double kStage = 1.0 - 0.5 * std::numbers::sqrt2;  // Alexander's gamma
  static constexpr int kMostSteps = 30;                              // of Halley's method: three are the rule

  [[nodiscard]] double power(double velocity) const noexcept {
    return std::copysign(std::pow(std::abs(velocity), exponent_), velocity);
  }

  /// The force over c.
  [[nodiscard]] double braced(const Motion& motion) noexcept {
    const double travel_m = motion.displacement_m - displacement_m_;
    displacement_m_ = motion.displacement_m;
    const double travel = kStage * travel_m / stretch_m_;
    const double first = relaxed(share_ + travel);
    share_ = relaxed(share_ + (1.0 - kStage) / kStage * (first - share_) + travel);
    return share_;
  }

  /// Solves y + b sign(y) |y|^(1/n) = a for y, b the time of a stage over the stretch: for n up to 1 a convex function
  /// of y, else of z = y^(1/n), z^n + b z = |a|. Halley's method from the root before, where that is near, else from
  /// above.
  [[nodiscard]] double relaxed(double a) noexcept {
    const double size = std::abs(a);
    if (size == 0.0) return 0.0;
    const double b = kStage * sample_period_s_ / stretch_m_;
    const bool is_in_velocity = exponent_ > 1.0;
    const double power = is_in_velocity ? exponent_ : 1.0 / exponent_;
    const double of_power = is_in_velocity ? 1.0 : b;
    const double of_first = is_in_velocity ? b : 1.0;
    const auto step_from = [=](double root) {
      const double raised = of_power * std::pow(root, power);
      const double rise = power * raised / root;
      const double slope = of_first + rise;
      const double newton = (of_first * root + raised - size) / slope;
      return newton / (1.0 - 0.5 * newton / root * (power - 1.0) * rise / slope);
    };
    // Held for long, the force decays to less than a number can tell.
    double step = root_ > 0.0 ? step_from(root_) : std::numeric_limits<double>::infinity();
    if (std::abs(step) < 0.25 * root_)
      root_ -= step;
    else
      root_ = std::min(size / of_first, std::pow(size / of_power, 1.0 / power));
    // What is left after a step is of the order of its cube.
    for (int i = 0; i < kMostSteps && root_ > 0.0 && !(std::abs(step) < 1e-5 * root_); ++i) {
      step = step_from(root_);
      root_ -= step;
    }
    return std::copysign(is_in_velocity ? std::pow(root_, exponent_) : root_, a);
  }

  double damping_n_s_per_m_;
  double exponent_;
  double stretch_m_;
  double sample_period_s_;
  double displacement_m_ = 0.0;
  double share_ = 0.0;  // of c, the force
  double root_ = 0.0;   // of the equation of the stage before
};

}  // namespace hybridtest
