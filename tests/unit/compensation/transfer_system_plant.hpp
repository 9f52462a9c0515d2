#pragma once

#include <array>
#include <complex>

#include "compensation/transfer_system_model.hpp"

namespace hybridtest {

/// u/x of the model's three equations, one eliminated after the other.
inline std::complex<double> inverse_transfer_function(const TransferSystemModel& p, std::complex<double> s) {
  const std::complex<double> force = (p.mass_kg * s + p.damping_n_s_per_m) * s + p.stiffness_n_per_m;
  const std::complex<double> z = (s + p.a3_per_s) * force + p.a2_n_per_m * s;
  return (1.0 + ((s + p.beta1_per_s) * s + p.beta2_per_s2) * z / p.a1beta0_n_per_m_s3) / p.gain;
}

/// The model's equations by Runge-Kutta, the command held over a period.
class TransferSystemPlant {
 public:
  explicit TransferSystemPlant(const TransferSystemModel& model) : p_{model} {}

  void advance(double command_m, double period_s, int steps = 1) {
    const double h = period_s / steps;
    for (int i = 0; i < steps; ++i) {
      const State k1 = rate(s_, command_m);
      const State k2 = rate(moved(k1, 0.5 * h), command_m);
      const State k3 = rate(moved(k2, 0.5 * h), command_m);
      const State k4 = rate(moved(k3, h), command_m);
      for (std::size_t j = 0; j < s_.size(); ++j) s_[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
    }
  }
  [[nodiscard]] double force_n() const { return s_[2]; }
  [[nodiscard]] double displacement_m() const { return s_[3]; }

 private:
  using State = std::array<double, 5>;  // z, z', F, x, x'
  [[nodiscard]] State rate(const State& s, double u) const {
    return {s[1], p_.a1beta0_n_per_m_s3 * (p_.gain * u - s[3]) - p_.beta1_per_s * s[1] - p_.beta2_per_s2 * s[0],
            s[0] - p_.a2_n_per_m * s[4] - p_.a3_per_s * s[2], s[4],
            (s[2] - p_.damping_n_s_per_m * s[4] - p_.stiffness_n_per_m * s[3]) / p_.mass_kg};
  }
  [[nodiscard]] State moved(const State& by, double h) const {
    State s = s_;
    for (std::size_t j = 0; j < s.size(); ++j) s[j] += h * by[j];
    return s;
  }

  TransferSystemModel p_;
  State s_{};
};

}  // namespace hybridtest
