#pragma once

#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Laws side by side on one degree of freedom: F = F1 + F2 + …, all at the same displacement and velocity.
class Parallel final : public Law {
 public:
  /// @param laws   at least one, none of them null.
  /// @throws ConfigError when there is none.
  explicit Parallel(std::vector<std::unique_ptr<Law>> laws);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override;
  void revert() noexcept override;
  void reset() noexcept override;
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;
  void ignore_reversals_within(double distance_m) noexcept override;

 private:
  std::vector<std::unique_ptr<Law>> laws_;
};

}  // namespace hybridtest
