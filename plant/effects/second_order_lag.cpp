#include "plant/effects/second_order_lag.hpp"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace hybridtest {
namespace {

/// Up to this ratio the two poles are real and far enough apart to be taken one by one.
constexpr double kPolesApart = 0.2;

}  // namespace

SecondOrderLag::SecondOrderLag(double time_constant_s, double ratio, double period_s) {
  is_resonant_ = ratio > kPolesApart && time_constant_s > FirstOrderLag::kShortest * period_s;
  if (!is_resonant_) {
    // Partial fractions: (T1 / (1 + T1 s) - T2 / (1 + T2 s)) / (T1 - T2), T1 + T2 = T, T1 T2 = r T^2.
    const double real_ratio = std::min(ratio, kPolesApart);
    const double slow = 0.5 * (1.0 + std::sqrt(1.0 - 4.0 * real_ratio));
    const double fast = real_ratio / slow;
    slow_ = {slow * time_constant_s, period_s};
    fast_ = {fast * time_constant_s, period_s};
    slow_share_ = slow / (slow - fast);
    fast_share_ = fast / (slow - fast);
    return;
  }
  // The signal and its rise over the sample make the system autonomous.
  const double angle = period_s / time_constant_s;
  const Eigen::Matrix4d generator{{0.0, angle, 0.0, 0.0},
                                  {-angle / ratio, -angle / ratio, angle / ratio, 0.0},
                                  {0.0, 0.0, 0.0, 1.0},
                                  {0.0, 0.0, 0.0, 0.0}};
  const Eigen::Matrix4d exponential = generator.exp();
  transition_ = exponential.topLeftCorner<2, 2>();
  from_newest_ = exponential.block<2, 1>(0, 3);
  from_previous_ = exponential.block<2, 1>(0, 2) - from_newest_;
}

double SecondOrderLag::step(double newest) noexcept {
  if (!is_resonant_) return slow_share_ * slow_.step(newest) - fast_share_ * fast_.step(newest);
  state_ = (transition_ * state_ + from_previous_ * previous_ + from_newest_ * newest).eval();
  previous_ = newest;
  return state_[0];
}

void SecondOrderLag::reset() noexcept {
  slow_.reset();
  fast_.reset();
  state_.setZero();
  previous_ = 0.0;
}

}  // namespace hybridtest
