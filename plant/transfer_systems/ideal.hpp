#pragma once

#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// The actuator is where the command is.
class Ideal final : public TransferSystem {
 public:
  [[nodiscard]] double step(double command_m) noexcept override { return command_m; }
  void reset() noexcept override {}
};

}  // namespace hybridtest
