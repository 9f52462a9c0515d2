#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "core/time.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// First-order lag: tau dx/dt = u - x.
///
/// Exact for a command u that runs straight from sample to sample (first-order hold; Franklin,
/// Powell and Workman, Digital Control of Dynamic Systems, 1998, section 6.3), with
/// q = control period / tau:
///
///     x1 = exp(-q) x0 + (p - exp(-q)) u0 + (1 - p) u1,   p = (1 - exp(-q)) / q
///
/// At rest, command and displacement are zero one control period before the first step.
class FirstOrder final : public TransferSystem {
 public:
  struct Parameters {
    double time_constant_s = 0.0;
    double bandwidth_hz = 0.0;  // in its place where that is zero

    void serialize(ParameterArchive& archive) {
      archive.either({"time_constant_s", time_constant_s, {kPositive, "tau"}},
                     {"bandwidth_hz", bandwidth_hz, {kPositive, "at which the gain is down by 3 dB"}});
    }
  };

  /// @param time_constant_s  tau, a thousandth to a million control periods (what is faster is Ideal).
  /// @throws ConfigError for values outside this range.
  FirstOrder(double time_constant_s, Duration control_period);

  /// tau of the lag whose gain is down by 3 dB at `bandwidth_hz`: 1 / (2 pi bandwidth).
  /// @throws ConfigError unless positive.
  [[nodiscard]] static double time_constant_s_at(double bandwidth_hz);

  [[nodiscard]] double step(double command_m) noexcept override;
  void reset() noexcept override;

 private:
  double decay_;
  double weight_of_previous_;
  double weight_of_newest_;
  double displacement_m_ = 0.0;
  double previous_command_m_ = 0.0;
};

}  // namespace hybridtest
