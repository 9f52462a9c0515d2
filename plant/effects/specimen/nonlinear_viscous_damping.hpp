#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Damping with a power of the velocity beside the model's law, as of a fluid damper whose orifices open under pressure
/// (Seleemah and Constantinou, NCEER-97-0004, 1997); as the law Viscous. In series with it a brace that is not rigid:
/// its stiffness is c over the displacement d by which the force at 1 m/s stretches it (Maxwell's element with a power
/// of the velocity; Makris and Constantinou, J. Struct. Eng. 117, 1991, for the linear one). Implicit Euler, which is
/// stable however stiff the brace is, in two numbers of substeps, extrapolated to second order (Hairer and Wanner,
/// Solving Ordinary Differential Equations II, 1996, section IV.9), for motions that run straight from sample to
/// sample.
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
  void reset() noexcept override { displacement_m_ = share_ = 0.0; }

 private:
  static constexpr int kSubsteps = 2;      // and twice as many, of which the first order is taken off
  static constexpr int kNewtonSteps = 30;  // converges by squares from a half on

  [[nodiscard]] double power(double velocity) const noexcept {
    return std::copysign(std::pow(std::abs(velocity), exponent_), velocity);
  }

  /// The force over c.
  [[nodiscard]] double braced(const Motion& motion) noexcept {
    const double travel_m = motion.displacement_m - displacement_m_;
    displacement_m_ = motion.displacement_m;
    share_ = 2.0 * after_substeps(2 * kSubsteps, travel_m) - after_substeps(kSubsteps, travel_m);
    return share_;
  }

  [[nodiscard]] double after_substeps(int count, double travel_m) const noexcept {
    double share = share_;
    for (int i = 0; i < count; ++i) share = relaxed(share + travel_m / count / stretch_m_, sample_period_s_ / count);
    return share;
  }

  /// Solves y + b sign(y) |y|^(1/n) = a for y, b the substep over the stretch: for n up to 1 a convex function of y,
  /// else of z = y^(1/n), z^n + b z = |a|. Newton's method comes down from the upper end without passing the solution.
  [[nodiscard]] double relaxed(double a, double substep_s) const noexcept {
    const double size = std::abs(a);
    if (size == 0.0) return 0.0;
    const double b = substep_s / stretch_m_;
    const bool is_in_velocity = exponent_ > 1.0;
    const double power = is_in_velocity ? exponent_ : 1.0 / exponent_;
    const double of_power = is_in_velocity ? 1.0 : b;
    const double of_first = is_in_velocity ? b : 1.0;
    double root = std::min(size / of_first, std::pow(size / of_power, 1.0 / power));
    // Held for long, the force decays to less than a number can tell.
    for (int i = 0; i < kNewtonSteps && root > 0.0; ++i) {
      const double raised = of_power * std::pow(root, power);
      const double step = (of_first * root + raised - size) / (of_first + power * raised / root);
      root -= step;
      if (!(step > 1e-12 * root)) break;
    }
    return std::copysign(is_in_velocity ? std::pow(root, exponent_) : root, a);
  }

  double damping_n_s_per_m_;
  double exponent_;
  double stretch_m_;
  double sample_period_s_;
  double displacement_m_ = 0.0;
  double share_ = 0.0;  // of c, the force
};

}  // namespace hybridtest
