#include "plant/transfer_systems/second_order.hpp"

#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

SecondOrder::SecondOrder(const Parameters& parameters, Duration control_period)
    : line_{parameters.delay, control_period} {
  const double period_s = to_seconds(control_period);
  const Range below_ideal{.low = 0.0, .high = 10.0 / period_s, .low_open = true};
  expect_in_range("natural_frequency_hz", checked(parameters).natural_frequency_hz, below_ideal);
  const double frequency_hz = parameters.natural_frequency_hz;
  const double damping_ratio = parameters.damping_ratio;
  const double angle = 2.0 * std::numbers::pi * frequency_hz * period_s;
  before_corner_ = piece(angle * line_.corner_fraction(), damping_ratio);
  after_corner_ = piece(angle * (1.0 - line_.corner_fraction()), damping_ratio);
}

// With time in units of 1 / omega: d(x, v)/dt = A (x, v) + b u. Two more states, the command and
// its rise over the piece, make the system autonomous, so that one exponential holds everything.
SecondOrder::Piece SecondOrder::piece(double angle, double damping_ratio) {
  const Eigen::Matrix4d generator{{0.0, angle, 0.0, 0.0},
                                  {-angle, -2.0 * damping_ratio * angle, angle, 0.0},
                                  {0.0, 0.0, 0.0, 1.0},
                                  {0.0, 0.0, 0.0, 0.0}};
  const Eigen::Matrix4d exponential = generator.exp();
  const Eigen::Vector2d from_rise = exponential.block<2, 1>(0, 3);
  return {.transition = exponential.topLeftCorner<2, 2>(),
          .from_begin = exponential.block<2, 1>(0, 2) - from_rise,
          .from_end = from_rise};
}

double SecondOrder::step(double command_m) noexcept {
  const double begin_m = line_.delayed();
  line_.push(command_m);
  const double end_m = line_.delayed();
  if (line_.corner_fraction() > 0.0) advance(before_corner_, begin_m, line_.corner());
  advance(after_corner_, line_.corner(), end_m);
  return state_[0];
}

void SecondOrder::advance(const Piece& piece, double begin_m, double end_m) noexcept {
  state_ = (piece.transition * state_ + piece.from_begin * begin_m + piece.from_end * end_m).eval();
}

void SecondOrder::reset() noexcept {
  line_.reset();
  state_.setZero();
}

}  // namespace hybridtest
