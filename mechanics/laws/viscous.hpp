#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Fluid damper: F = c sign(v) |v|^n (Constantinou and Symans, NCEER-92-0032, 1992; energy per cycle: Seleemah and
/// Constantinou, NCEER-97-0004, 1997); linear for n = 1.
class Viscous final : public Law {
 public:
  struct Parameters {
    double damping_n_s_per_m = 0.0;
    double exponent = 1.0;

    void serialize(ParameterArchive& archive) {
      archive.required("damping_n_s_per_m", damping_n_s_per_m,
                       {.range = kNotNegative, .what = "c", .unit = "N (s/m)ⁿ"});
      archive.optional("exponent", exponent, {{.low = 0.1, .high = 3.0}, "n"});
    }
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
