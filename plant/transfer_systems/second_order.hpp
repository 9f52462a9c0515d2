#pragma once

#include <Eigen/Core>

#include "core/parameters/parameter_archive.hpp"
#include "core/time.hpp"
#include "plant/transfer_systems/delay_line.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// Servo-hydraulic actuator as second-order system with delay, of unit static gain:
///
///     x'' + 2 zeta omega x' + omega^2 x = omega^2 u(t - delay)
///
/// under-, critically or overdamped. Exact for a command u that runs straight from sample to
/// sample: both pieces between samples that a delay of broken sample count leaves are integrated
/// with their matrix exponentials (Van Loan, IEEE Trans. Automatic Control 23, 1978), which are
/// made at construction.
///
/// At rest, command and displacement are zero one control period before the first step.
class SecondOrder final : public TransferSystem {
 public:
  struct Parameters {
    double natural_frequency_hz = 0.0;
    double damping_ratio = 0.0;
    Duration delay{};

    void serialize(ParameterArchive& archive) {
      archive.required("natural_frequency_hz", natural_frequency_hz,
                       {.range = kPositive, .values = "more than 0, at most 10 times the control rate"});
      archive.required("damping_ratio", damping_ratio, {{.low = 0.0, .high = 10.0, .low_open = true}});
      archive.optional("delay_s", delay, {{.low = 0.0, .high = 10.0}, "of the command before the actuator"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  SecondOrder(const Parameters& parameters, Duration control_period);

  [[nodiscard]] double step(double command_m) noexcept override;
  void reset() noexcept override;

 private:
  /// Displacement and velocity over omega, both in m.
  using State = Eigen::Vector2d;

  /// Carries the state over a piece of time along which the command runs straight.
  struct Piece {
    Eigen::Matrix2d transition;
    Eigen::Vector2d from_begin;  // weight of the command at the begin of the piece
    Eigen::Vector2d from_end;
  };

  /// @param angle   omega times the length of the piece.
  [[nodiscard]] static Piece piece(double angle, double damping_ratio);
  void advance(const Piece& piece, double begin_m, double end_m) noexcept;

  DelayLine line_;
  Piece before_corner_;
  Piece after_corner_;
  State state_ = State::Zero();
};

}  // namespace hybridtest
