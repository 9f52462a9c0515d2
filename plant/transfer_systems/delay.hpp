#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "core/time.hpp"
#include "plant/transfer_systems/delay_line.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// The actuator is where the command was `delay` ago; at zero before the first command. Between samples the command is
/// taken as smooth, see DelayLine::delayed_smoothly().
class Delay final : public TransferSystem {
 public:
  struct Parameters {
    double delay_s = 0.0;

    void serialize(ParameterArchive& archive) { archive.required("delay_s", delay_s, {{.low = 0.0, .high = 10.0}}); }
  };

  /// @throws ConfigError as DelayLine.
  Delay(Duration delay, Duration control_period) : line_{delay, control_period} {}

  [[nodiscard]] double step(double command_m) noexcept override;
  void reset() noexcept override { line_.reset(); }

 private:
  DelayLine line_;
};

}  // namespace hybridtest
