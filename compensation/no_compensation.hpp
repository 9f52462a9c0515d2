#pragma once

#include "compensation/compensator.hpp"

namespace hybridtest {

/// Sends the target as the command: what every other compensator is measured against.
class NoCompensation final : public Compensator {
 public:
  [[nodiscard]] double command(const CompensatorInput& input) noexcept override { return input.target_m; }
  void reset() noexcept override {}
};

}  // namespace hybridtest
