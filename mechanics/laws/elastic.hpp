#pragma once

#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Linear spring: force = stiffness * displacement.
class Elastic final : public Law {
 public:
  /// @param stiffness_n_per_m   positive.
  /// @throws ConfigError for values outside this range.
  explicit Elastic(double stiffness_n_per_m);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override {}
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return stiffness_n_per_m_; }

 private:
  double stiffness_n_per_m_;
};

}  // namespace hybridtest
