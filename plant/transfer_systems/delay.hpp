#pragma once

#include "core/time.hpp"
#include "plant/transfer_systems/delay_line.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// The actuator is where the command was `delay` ago; at zero before the first command.
class Delay final : public TransferSystem {
 public:
  /// @throws ConfigError as DelayLine.
  Delay(Duration delay, Duration control_period) : line_{delay, control_period} {}

  [[nodiscard]] double step(double command_m) noexcept override;
  void reset() noexcept override { line_.reset(); }

 private:
  DelayLine line_;
};

}  // namespace hybridtest
