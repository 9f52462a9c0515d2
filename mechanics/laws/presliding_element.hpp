#pragma once

#include <algorithm>
#include <cmath>

namespace hybridtest {

/// Share of a dry friction that acts, with the sign of the motion. Before it slides it follows the displacement since
/// the last reversal: dz / dx = (1 - z sign(dx))^i / d, d the pre-sliding displacement and i an exponent (Dahl, The
/// Aerospace Corporation TOR-0158, 1968). With i = 0 it is elastoplastic and slides after d; with i = 1 it comes near
/// sliding by an exponential, as in the LuGre model (Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995). The
/// solution is exact from sample to sample. It holds at rest and needs no sign of a noisy velocity.
class PreslidingElement {
 public:
  /// @param presliding_displacement_m   positive.
  /// @param exponent                    not negative.
  explicit PreslidingElement(double presliding_displacement_m, double exponent = 0.0)
      : presliding_displacement_m_{presliding_displacement_m}, exponent_{exponent} {}

  /// -limit to limit. Called once per sample.
  /// @param limit   at which it slides now, over that of which the pre-sliding displacement was given.
  [[nodiscard]] double share(double displacement_m, double limit = 1.0) noexcept {
    const double travel = (displacement_m - displacement_m_) / presliding_displacement_m_;
    displacement_m_ = displacement_m;
    if (exponent_ == 0.0 || travel == 0.0) return share_ = std::clamp(share_ + travel, -limit, limit);
    const double sign = std::copysign(1.0, travel);
    const double left = 1.0 - sign * std::clamp(share_ / limit, -1.0, 1.0);
    return share_ = sign * limit * (1.0 - left_after(std::abs(travel) / limit, left));
  }
  void reset() noexcept { share_ = displacement_m_ = 0.0; }

 private:
  /// Solves dw / du = -w^i from w: w^(1 - i) falls by (1 - i) u, not below zero.
  [[nodiscard]] double left_after(double path, double left) const noexcept {
    constexpr double kExponential = 1e-6;  // this near to 1, its exponential is as exact
    if (left <= 0.0) return 0.0;
    const double rest = 1.0 - exponent_;
    if (std::abs(rest) < kExponential) return left * std::exp(-path);
    const double fall = rest * path * std::pow(left, -rest);
    return fall < 1.0 ? left * std::exp(std::log1p(-fall) / rest) : 0.0;
  }

  double presliding_displacement_m_;
  double exponent_;
  double share_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
