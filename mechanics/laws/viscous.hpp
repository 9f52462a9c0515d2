#pragma once

#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Fluid damper: F = c sign(v) |v|^n (Constantinou and Symans, NCEER-92-0032, 1992); linear for n = 1.
class Viscous final : public Law {
 public:
  struct Parameters {
    double damping_n_s_per_m = 0.0;  // [N (s/m)^n] not negative
    double exponent = 1.0;           // [-] n, 0.1 to 3
  };

  /// @throws ConfigError for values outside these ranges.
  explicit Viscous(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override {}
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return 0.0; }

 private:
  Parameters parameters_;
};

}  // namespace hybridtest
