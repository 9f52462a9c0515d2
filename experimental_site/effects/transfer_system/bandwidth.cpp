#include "experimental_site/effects/transfer_system/bandwidth.hpp"

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace hybridtest {
namespace {

/// Up to this ratio the two poles are real and far enough apart to be taken one by one.
constexpr double kPolesApart = 0.2;
/// Of a time constant as many times shorter than a sample, nothing is left but its delay.
constexpr double kShortest = 1e-3;

/// A first-order lag between samples, for a command that runs straight.
struct Lag {
  double decay = 0.0;
  double from_previous = 0.0;
  double from_newest = 1.0;
};

Lag lag_of(double time_constant_s, double period_s) {
  const double late = time_constant_s / period_s;
  if (late < kShortest) return {.decay = 0.0, .from_previous = late, .from_newest = 1.0 - late};
  const double decay = std::exp(-1.0 / late);
  const double mean_decay = -std::expm1(-1.0 / late) * late;
  return {.decay = decay, .from_previous = mean_decay - decay, .from_newest = 1.0 - mean_decay};
}

}  // namespace

Bandwidth::Bandwidth(std::span<const double> values, double sample_period_s) {
  const double time_constant_s = values[0];
  const double ratio = values[1];
  if (ratio <= kPolesApart || time_constant_s < kShortest * sample_period_s) {
    // Partial fractions: (T1 / (1 + T1 s) - T2 / (1 + T2 s)) / (T1 - T2), of which T1 + T2 = T and T1 T2 = r T^2.
    const double slow = 0.5 * (1.0 + std::sqrt(1.0 - 4.0 * std::min(ratio, kPolesApart)));
    const double fast = std::min(ratio, kPolesApart) / slow;
    const Lag lags[2] = {lag_of(slow * time_constant_s, sample_period_s),
                         lag_of(fast * time_constant_s, sample_period_s)};
    for (Eigen::Index i = 0; i < 2; ++i) {
      transition_(i, i) = lags[i].decay;
      from_previous_[i] = lags[i].from_previous;
      from_newest_[i] = lags[i].from_newest;
    }
    output_ = Eigen::Vector2d{slow, -fast} / (slow - fast);
    return;
  }
  // The command and its rise over the sample make the system autonomous; the velocity times T is the second state.
  const double angle = sample_period_s / time_constant_s;
  const Eigen::Matrix4d generator{{0.0, angle, 0.0, 0.0},
                                  {-angle / ratio, -angle / ratio, angle / ratio, 0.0},
                                  {0.0, 0.0, 0.0, 1.0},
                                  {0.0, 0.0, 0.0, 0.0}};
  const Eigen::Matrix4d exponential = generator.exp();
  transition_ = exponential.topLeftCorner<2, 2>();
  from_newest_ = exponential.block<2, 1>(0, 3);
  from_previous_ = exponential.block<2, 1>(0, 2) - from_newest_;
  output_ = Eigen::Vector2d{1.0, 0.0};
}

void Bandwidth::before(const StageSample& /*sample*/, Motion& command) noexcept {
  const double newest_m = command.displacement_m;
  state_ = (transition_ * state_ + from_previous_ * previous_m_ + from_newest_ * newest_m).eval();
  previous_m_ = newest_m;
  command.displacement_m = output_.dot(state_);
}

void Bandwidth::reset() noexcept {
  state_.setZero();
  previous_m_ = 0.0;
}

}  // namespace hybridtest
