#pragma once

#include "compensation/force_compensator.hpp"

namespace hybridtest {

/// Hands the measured force on: what every other compensator on forces is measured against.
class NoForceCompensation final : public ForceCompensator {
 public:
  [[nodiscard]] double corrected_force(const ForceSample& sample) noexcept override { return sample.measured_force_n; }
  void reset() noexcept override {}
};

}  // namespace hybridtest
