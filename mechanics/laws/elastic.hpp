#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Linear spring: force = stiffness * displacement.
class Elastic final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;

    void serialize(ParameterArchive& archive) { archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive}); }
  };

  /// @throws ConfigError for values outside their ranges.
  explicit Elastic(const Parameters& parameters);
  explicit Elastic(double stiffness_n_per_m) : Elastic{Parameters{stiffness_n_per_m}} {}

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override {}
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return stiffness_n_per_m_; }

 private:
  double stiffness_n_per_m_;
};

}  // namespace hybridtest
